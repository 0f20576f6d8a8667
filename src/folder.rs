//! New folders of files, put in place as a whole.

use crate::failure::Failure;
use crate::job::Watch;
use crate::output::{WRITING, told};
use rayon::prelude::*;
use std::fs;
use std::io;
use std::path::Path;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Makes the name and content of the file with a number.
pub type MakeFile<'a> = dyn Fn(usize) -> Result<(String, Vec<u8>), Failure> + Sync + 'a;

/// Whether a folder could be made at `path`, found out before long work begins. Leaves no trace.
///
/// Errors: something there that is not an empty folder, a place where nothing can be written.
pub fn check_new(path: &Path) -> Result<(), Failure> {
    match fs::read_dir(path).map(|mut entries| entries.next().is_none()) {
        Ok(true) => {}
        Ok(false) => {
            let what = "a folder with something in it, which is not written over; name a new one";
            return Err(Failure::of(path, what));
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(Failure::of(path, format!("not a folder to write to: {}", told(&error)))),
    }
    tempfile::tempdir_in(beside(path)).map(|_| ()).map_err(|error| {
        Failure::of(
            path,
            format!("cannot be written: its folder {}: {}", beside(path).display(), told(&error)),
        )
    })
}

/// Makes `count` files and puts them in place as a new folder at once, or leaves everything as it was.
///
/// Errors: what makes the files, what the system says, an interruption.
pub fn write(path: &Path, count: usize, make: &MakeFile, watch: &Watch) -> Result<(), Failure> {
    // Held all the time, so that an interruption finds the unfinished folder gone.
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    let failed = |error: io::Error| Failure::of(path, format!("cannot be written: {}", told(&error)));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".trullo-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Not the narrow default of temporary folders; the user's mask still applies.
        builder.permissions(fs::Permissions::from_mode(0o777));
    }
    let unfinished = builder.tempdir_in(beside(path)).map_err(failed)?;
    let done = AtomicUsize::new(0);
    (0..count).into_par_iter().try_for_each(|number| {
        watch.go_on()?;
        let (name, content) = make(number)?;
        fs::write(unfinished.path().join(name), content).map_err(failed)?;
        watch.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / count as f32);
        Ok::<_, Failure>(())
    })?;
    match fs::remove_dir(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(failed(error)),
        _ => {}
    }
    fs::rename(unfinished.path(), path).map_err(failed)?;
    // Nothing is left under its old name.
    let _ = unfinished.keep();
    Ok(())
}

/// The folder that a folder is in.
fn beside(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
