//! Everything done to a document, on disk before it is shown, so that no end of the program loses it.
//!
//! A session is a folder: `scene.trullo` is the document as it was opened, `journal` says in its first line where that
//! came from, and in each further line one [`JournalEntry`], or one [`Vary`] for what was done to variants. The program that works on a session holds a lock on its
//! journal; a session that nobody holds was left behind. The user's own file is never touched.
//!
//! What was done is with the system before it is shown, so that it outlives the program. A thread then has the disk take
//! it, which may last seconds on a busy one: if the power fails, what was done meanwhile may be lost.

use crate::variants::{Variants, Vary};
use blobtree::{JournalEntry, Scene, SceneSources};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::SystemTime;

/// The document as it was opened.
const BASE: &str = "scene.trullo";

/// What was done since.
const JOURNAL: &str = "journal";

/// Most bytes of one line that are read; a command with a large drawing takes some hundred thousand.
const LONGEST_LINE: u64 = 256 << 20;

/// The first line of a journal.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    format: String,
    version: u32,
    /// The user's file, if the document has one.
    file: Option<PathBuf>,
    /// Whether the scene holds work that is in no file, although nothing was done in this session yet.
    #[serde(default)]
    unsaved: bool,
}

impl Header {
    const FORMAT: &'static str = "trullo-session";
    const VERSION: u32 = 1;
}

/// Why a session cannot be kept or read.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The system would not let us.
    #[error("{path}: {step}: {error}", path = path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was being done.
        step: &'static str,
        /// What the system says.
        #[source]
        error: io::Error,
    },
    /// The scene or an entry has no legal text.
    #[error("{0}")]
    Scene(#[from] blobtree::SceneError),
    /// It is no journal, or one of a newer program.
    #[error("{path}: not a journal of this version: {what}", path = path.display())]
    Foreign {
        /// The journal.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// A session that is being written.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    /// Locked for as long as it is open.
    file: File,
    disk: ToDisk,
}

impl Journal {
    /// Begins a session in a new folder in `sessions`, which is made if it is not there. `unsaved` says that the scene
    /// is worth bringing back even if nothing more is done.
    ///
    /// Errors: a folder that cannot be written; a scene without text.
    pub fn begin(
        sessions: &Path,
        scene: &Scene,
        file: Option<&Path>,
        unsaved: bool,
    ) -> Result<Self, JournalError> {
        let failed = |path: &Path, step| {
            let path = path.to_path_buf();
            move |error| JournalError::Io { path, step, error }
        };
        fs::create_dir_all(sessions).map_err(failed(sessions, "making the folder for sessions"))?;
        let folder = tempfile::Builder::new().prefix("session-").tempdir_in(sessions);
        let folder = folder.map_err(failed(sessions, "making a folder in it"))?;
        let base = folder.path().join(BASE);
        let text = scene.to_text()?;
        let mut file_of_base = File::create_new(&base).map_err(failed(&base, "making it"))?;
        file_of_base.write_all(text.as_bytes()).map_err(failed(&base, "writing it"))?;
        let path = folder.path().join(JOURNAL);
        let mut journal = File::create_new(&path).map_err(failed(&path, "making it"))?;
        journal.try_lock().map_err(|e| failed(&path, "locking it")(e.into()))?;
        let file = file.map(|file| std::path::absolute(file).unwrap_or_else(|_| file.into()));
        let header = Header { format: Header::FORMAT.into(), version: Header::VERSION, file, unsaved };
        let line =
            serde_json::to_string(&header).map_err(|e| failed(&path, "writing its first line")(e.into()))?;
        append(&mut journal, &line).map_err(failed(&path, "writing its first line"))?;
        let disk = ToDisk::start(&[&file_of_base, &journal]).map_err(failed(&path, "preparing it"))?;
        Ok(Self { folder: folder.keep(), file: journal, disk })
    }

    /// Writes an entry, which outlives the program from then on, and has the disk take it. `scene` is the document's
    /// before it.
    ///
    /// Errors: a disk that is full or gone; an entry without text. Then the entry is not in the journal, or not on the
    /// disk.
    pub fn add(&mut self, entry: &JournalEntry, scene: &Scene) -> Result<(), JournalError> {
        self.add_line(&entry.to_line(scene)?)
    }

    /// Writes what is done to variants, likewise.
    ///
    /// Errors: as [`Self::add`].
    pub fn add_vary(&mut self, vary: &Vary) -> Result<(), JournalError> {
        let line = serde_json::to_string(vary).map_err(|e| self.failed(e.into()))?;
        self.add_line(&line)
    }

    fn add_line(&mut self, line: &str) -> Result<(), JournalError> {
        append(&mut self.file, line).and_then(|()| self.disk.take()).map_err(|error| self.failed(error))
    }

    fn failed(&self, error: io::Error) -> JournalError {
        JournalError::Io { path: self.folder.join(JOURNAL), step: "writing what was done", error }
    }

    /// Ends the session: its document is saved, or is not wanted. What cannot be removed stays, and is offered again.
    pub fn end(self) {
        let folder = self.folder.clone();
        drop(self);
        let _ = fs::remove_dir_all(folder);
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        // The thread may hold the file for a while.
        let _ = self.file.unlock();
    }
}

/// Writes a whole line, or takes back what of it was written.
fn append(file: &mut File, line: &str) -> io::Result<()> {
    let end = file.seek(SeekFrom::End(0))?;
    let written = file.write_all(format!("{line}\n").as_bytes());
    if written.is_err() {
        let _ = file.set_len(end);
    }
    written
}

/// A thread that has the disk take what was written to some files.
#[derive(Debug)]
struct ToDisk {
    wake: Sender<()>,
    failed: Receiver<io::Error>,
}

impl ToDisk {
    /// Starts it, and has all of these files taken once. It ends when this is dropped.
    ///
    /// Errors: a system without a thread or a file to spare.
    fn start(files: &[&File]) -> io::Result<Self> {
        let files: Vec<File> = files.iter().map(|file| file.try_clone()).collect::<Result<_, _>>()?;
        let (wake, woken) = mpsc::channel();
        let (fail, failed) = mpsc::channel();
        std::thread::Builder::new().name("journal".into()).spawn(move || {
            let mut next = files.iter();
            loop {
                // One after the other at first; then the last, which grows.
                let Some(file) = next.next().or(files.last()) else { return };
                if let Err(error) = file.sync_data()
                    && fail.send(error).is_err()
                {
                    return;
                }
                if next.len() == 0 && woken.recv().is_err() {
                    return;
                }
                // Whatever else was written meanwhile is taken with it.
                while woken.try_recv().is_ok() {}
            }
        })?;
        Ok(Self { wake, failed })
    }

    /// Has the disk take what was written.
    ///
    /// Errors: what it could not take before.
    fn take(&self) -> io::Result<()> {
        // Without the thread, what it said last says why.
        let _ = self.wake.send(());
        self.failed.try_recv().map_or(Ok(()), Err)
    }
}

/// A session that was left behind.
#[derive(Debug)]
pub struct LeftBehind {
    folder: PathBuf,
    /// Locked, so that no other program takes it, too.
    journal: File,
    /// The user's file that was worked on, if there was one.
    pub file: Option<PathBuf>,
    /// How many things were done.
    pub steps: usize,
    /// When the last was done.
    pub last: SystemTime,
}

/// What was brought back.
#[derive(Debug)]
pub struct Recovered {
    /// The document, with all its variants and their histories.
    pub variants: Variants,
    /// Its journal, to be gone on with.
    pub journal: Journal,
    /// Why later entries were lost, if some were.
    pub lost: Option<String>,
}

impl LeftBehind {
    /// The sessions in a folder that nobody works on, the latest first. Those in which nothing was done, and what is
    /// no session, are passed over.
    pub fn all(sessions: &Path) -> Vec<Self> {
        let folders = fs::read_dir(sessions).into_iter().flatten().flatten();
        let mut found: Vec<Self> = folders.filter_map(|entry| Self::look(entry.path())).collect();
        found.sort_by_key(|session| std::cmp::Reverse(session.last));
        found
    }

    fn look(folder: PathBuf) -> Option<Self> {
        let journal = OpenOptions::new().read(true).write(true).open(folder.join(JOURNAL)).ok()?;
        journal.try_lock().ok()?;
        let last = journal.metadata().and_then(|metadata| metadata.modified()).ok()?;
        let mut lines = Lines::new(&journal).ok()?;
        let header = header(&folder, &lines.next()?.ok()?).ok()?;
        let steps = lines.map_while(Result::ok).count();
        (steps > 0 || header.unsaved).then_some(Self { folder, journal, file: header.file, steps, last })
    }

    /// Does again all that was done. What was cut off in the middle of a line was never shown, and is dropped.
    ///
    /// Errors: a document that cannot be read. Entries that cannot be done again end the way; see
    /// [`Recovered::lost`].
    pub fn recover(mut self, sources: &mut dyn SceneSources) -> Result<Recovered, JournalError> {
        let path = self.folder.join(BASE);
        let bytes = fs::read(&path).map_err(|error| JournalError::Io { path, step: "reading it", error })?;
        let mut variants = Variants::of(Scene::from_bytes(&bytes, sources)?)?;
        let journal = self.folder.join(JOURNAL);
        let failed = |step| {
            let path = journal.clone();
            move |error| JournalError::Io { path, step, error }
        };
        let mut lines = Lines::new(&self.journal).map_err(failed("reading it"))?;
        let first = lines.next().transpose().map_err(failed("reading it"))?.unwrap_or_default();
        header(&self.folder, &first)?;
        let (mut lost, mut good) = (None, lines.read);
        while let Some(line) = lines.next() {
            let line = line.map_err(failed("reading it"))?;
            if let Err(reason) = repeat(&mut variants, &line, sources) {
                lost = Some(reason);
                break;
            }
            good = lines.read;
        }
        self.journal.set_len(good).map_err(failed("dropping its broken end"))?;
        self.journal.seek(SeekFrom::End(0)).map_err(failed("going to its end"))?;
        let disk = ToDisk::start(&[&self.journal]).map_err(failed("preparing it"))?;
        let journal = Journal { folder: self.folder, file: self.journal, disk };
        Ok(Recovered { variants, journal, lost })
    }

    /// Throws the session away.
    pub fn forget(self) {
        drop(self.journal);
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Does again what a line says.
///
/// Errors: a line that says nothing, or something that cannot be done; why, in words.
fn repeat(variants: &mut Variants, line: &[u8], sources: &mut dyn SceneSources) -> Result<(), String> {
    if line.starts_with(b"{\"variant\":") {
        let vary = serde_json::from_slice(line).map_err(|e| e.to_string())?;
        return variants.vary(vary).map_err(|e| e.to_string());
    }
    let entry = JournalEntry::from_line(line, variants.document().scene(), sources);
    let done = entry.map_err(|e| e.to_string())?;
    variants.repeat(done).map(drop).map_err(|e| e.to_string())
}

/// Errors: a line that is no header of this version.
fn header(folder: &Path, line: &[u8]) -> Result<Header, JournalError> {
    let foreign = |what: String| JournalError::Foreign { path: folder.join(JOURNAL), what };
    let header: Header = serde_json::from_slice(line).map_err(|e| foreign(e.to_string()))?;
    if header.format != Header::FORMAT || header.version != Header::VERSION {
        return Err(foreign(format!("{} {}", header.format, header.version)));
    }
    Ok(header)
}

/// The whole lines of a journal, without their ends.
struct Lines<'a> {
    reader: BufReader<&'a File>,
    /// Bytes of all lines so far.
    read: u64,
}

impl<'a> Lines<'a> {
    fn new(mut file: &'a File) -> io::Result<Self> {
        file.rewind()?;
        Ok(Self { reader: BufReader::new(file), read: 0 })
    }
}

impl Iterator for Lines<'_> {
    type Item = io::Result<Vec<u8>>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut line = Vec::new();
        let read = io::Read::take(&mut self.reader, LONGEST_LINE).read_until(b'\n', &mut line);
        match read {
            Err(error) => Some(Err(error)),
            // A line without an end was being written when the program ended.
            Ok(_) if line.pop() != Some(b'\n') => None,
            Ok(read) => {
                self.read += read as u64;
                Some(Ok(line))
            }
        }
    }
}
