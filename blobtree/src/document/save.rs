//! Saving without ever leaving half a file.

use crate::scene::SceneError;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// How many older versions of a scene file are kept beside it.
pub const DEFAULT_OLDER_VERSIONS: usize = 3;

/// Why a file could not be saved. The file is as it was before.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The scene has no legal text.
    #[error("the scene cannot be written: {0}")]
    Scene(#[from] SceneError),
    /// The place is taken by something that is not a file, such as a folder.
    #[error("`{0}` is not a file, so it cannot be written over; choose another name")]
    NotAFile(PathBuf),
    /// The system would not let us.
    #[error("`{path}` cannot be saved: {step}: {error}")]
    Io {
        /// The file to be saved.
        path: PathBuf,
        /// What was being done.
        step: &'static str,
        /// What the system says.
        #[source]
        error: io::Error,
    },
}

/// Writes a file so that at any moment, whatever fails, either the old or the new content is there in full.
///
/// The content goes to a temporary file in the same folder, is flushed to the disk, and takes the file's place
/// at once. The `older_versions` last contents are kept as `name~1` (the newest), `name~2` and so on. If
/// `path` is a link, the file that it points to is written.
///
/// Errors: a folder that is not there or not writable, a full disk, a target that is not a file. Then the
/// file is as it was, and at most the older versions have been renumbered.
pub fn write_atomically(path: &Path, content: &[u8], older_versions: usize) -> Result<(), SaveError> {
    let failed = |step| move |error| SaveError::Io { path: path.into(), step, error };
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.into());
    let existing = match fs::metadata(&target) {
        Ok(metadata) if metadata.is_file() => Some(metadata),
        Ok(_) => return Err(SaveError::NotAFile(path.into())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(failed("looking at it")(error)),
    };
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".trullo-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Not the narrow default of temporary files; the user's mask still applies.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(folder).map_err(failed("creating a file in its folder"))?;
    if let Some(metadata) = &existing {
        let keep = temporary.as_file().set_permissions(metadata.permissions());
        keep.map_err(failed("giving the new file the old one's permissions"))?;
    }
    temporary.write_all(content).map_err(failed("writing"))?;
    temporary.as_file().sync_all().map_err(failed("flushing it to the disk"))?;
    if existing.is_some() && older_versions > 0 {
        keep_older(&target, older_versions).map_err(failed("keeping the older version"))?;
    }
    temporary.persist(&target).map_err(|e| failed("putting the new file in its place")(e.error))?;
    // The content is safe; a folder that cannot be flushed, as on some systems, is no failure.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// Moves `name~1` to `name~2` and so on, and makes `name~1` another name of the file, which stays in place.
fn keep_older(target: &Path, count: usize) -> io::Result<()> {
    for number in (1..count).rev() {
        let from = older(target, number);
        if from.try_exists()? {
            fs::rename(from, older(target, number + 1))?;
        }
    }
    let newest = older(target, 1);
    match fs::remove_file(&newest) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    // Some file systems have no second names; there, a copy.
    fs::hard_link(target, &newest).or_else(|_| fs::copy(target, &newest).map(drop))
}

fn older(target: &Path, number: usize) -> PathBuf {
    let mut name = OsString::from(target);
    name.push(format!("~{number}"));
    name.into()
}
