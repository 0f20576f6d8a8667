//! What is kept from one start to the next: how the user likes to work, and the files worked on lately with a picture
//! of each. All of it is a convenience: what is broken or gone is passed over.

use crate::camera::Camera;
use crate::settings::Settings;
use crate::thumbnail;
use blobtree::{NodeRef, write_atomically};
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use glam::Vec2;
use polygonizer::Cancel;
use serde_json::{Map, Value, json};
use std::fs;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::Duration;

/// Most files that are remembered.
const MOST: usize = 12;

/// The size of a picture, pixels: twice what it takes on the screen.
pub const PICTURE: [usize; 2] = [192, 144];

/// Largest picture file that is read, bytes.
const LARGEST: u64 = 1 << 20;

/// The file for settings and names.
const FILE: &str = "modeler.json";

/// The folder for pictures.
const PICTURES: &str = "pictures";

/// How long the end of the program waits for the disk.
const PATIENCE: Duration = Duration::from_secs(2);

/// A file that was worked on.
#[derive(Clone)]
pub struct Recent {
    /// The file.
    pub file: PathBuf,
    /// Whether it was there when somebody looked last.
    pub is_there: bool,
    /// What is in it.
    pub picture: Option<Arc<ColorImage>>,
    texture: Option<TextureHandle>,
}

impl Recent {
    fn new(file: PathBuf, is_there: bool, picture: Option<Arc<ColorImage>>) -> Self {
        Self { file, is_there, picture, texture: None }
    }

    /// The picture on the screen, if there is one.
    pub(crate) fn texture(&mut self, ctx: &Context) -> Option<&TextureHandle> {
        let picture = self.picture.as_ref()?;
        let load = || ctx.load_texture("recent", picture.clone(), TextureOptions::LINEAR);
        Some(self.texture.get_or_insert_with(load))
    }
}

/// Settings and files, and the thread that keeps them.
#[derive(Default)]
pub struct Kept {
    /// The files, the latest first.
    pub recent: Vec<Recent>,
    /// What was to be written last.
    written: Option<(Settings, Vec<PathBuf>)>,
    keeper: Option<Keeper>,
}

struct Keeper {
    jobs: Sender<Job>,
    answers: Receiver<Recent>,
}

enum Job {
    Write(String),
    Look(Vec<PathBuf>),
    Draw(PathBuf, NodeRef),
    End(Sender<()>),
}

impl Kept {
    /// What is kept in this folder, and the settings there, as far as they can be read.
    ///
    /// Errors: a system without a thread to spare.
    pub fn open(folder: &Path, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<(Self, Settings)> {
        let text = fs::read_to_string(folder.join(FILE)).unwrap_or_default();
        let kept = serde_json::from_str::<Value>(&text).unwrap_or_default();
        let (jobs, todo) = mpsc::channel();
        let (sender, answers) = mpsc::channel();
        let files: Vec<PathBuf> = files_in(&kept["recent"]);
        let shelf = Shelf { folder: folder.to_path_buf(), answers: sender, wake };
        std::thread::Builder::new().name("kept".into()).stack_size(32 << 20).spawn(move || {
            while let Ok(job) = todo.recv() {
                shelf.work(job);
            }
        })?;
        let _ = jobs.send(Job::Look(files.clone()));
        let recent = files.iter().map(|file| Recent::new(file.clone(), true, None)).collect();
        let settings = Settings::lenient(&kept["settings"]);
        let written = Some((settings, files));
        Ok((Self { recent, written, keeper: Some(Keeper { jobs, answers }) }, settings))
    }

    /// Takes in what was looked up, and has settings and names written if they have changed.
    pub fn follow(&mut self, settings: &Settings) {
        let Some(keeper) = &self.keeper else { return };
        for answer in keeper.answers.try_iter() {
            if let Some(known) = self.recent.iter_mut().find(|recent| recent.file == answer.file) {
                known.is_there = answer.is_there;
                if answer.picture.is_some() {
                    (known.picture, known.texture) = (answer.picture, None);
                }
            }
        }
        let files = || self.recent.iter().map(|recent| &recent.file);
        let same = |(known, names): &(Settings, Vec<PathBuf>)| known == settings && names.iter().eq(files());
        if !self.written.as_ref().is_some_and(same) {
            let files: Vec<PathBuf> = files().cloned().collect();
            let text = format!("{:#}\n", json!({ "settings": settings, "recent": files }));
            let _ = keeper.jobs.send(Job::Write(text));
            self.written = Some((*settings, files));
        }
    }

    /// A file was opened or saved, with this in it.
    pub fn remember(&mut self, file: &Path, root: &NodeRef) {
        let Some(keeper) = &self.keeper else { return };
        let file = std::path::absolute(file).unwrap_or_else(|_| file.into());
        let known = self.recent.iter().position(|recent| recent.file == file);
        let known = known.map(|place| self.recent.remove(place));
        let picture = known.and_then(|known| known.picture);
        self.recent.insert(0, Recent::new(file.clone(), true, picture));
        self.recent.truncate(MOST);
        let _ = keeper.jobs.send(Job::Draw(file, root.clone()));
    }

    /// A file is to be remembered no longer, such as one that is gone.
    pub fn forget(&mut self, file: &Path) {
        self.recent.retain(|recent| recent.file != file);
    }

    /// The folder that was worked in last.
    pub fn folder(&self) -> Option<&Path> {
        self.recent.first()?.file.parent()
    }
}

impl Drop for Kept {
    fn drop(&mut self) {
        if let Some(keeper) = self.keeper.take() {
            let (sender, ended) = mpsc::channel();
            if keeper.jobs.send(Job::End(sender)).is_ok() {
                // A disk that takes longer does without.
                let _ = ended.recv_timeout(PATIENCE);
            }
        }
    }
}

/// The names in a list; what is no absolute path is passed over.
fn files_in(list: &Value) -> Vec<PathBuf> {
    let names = list.as_array().into_iter().flatten().filter_map(Value::as_str).map(PathBuf::from);
    names.filter(|file| file.is_absolute()).take(MOST).collect()
}

impl Settings {
    /// Those in a JSON object; each that is not there, or not legal, is the usual one.
    pub(crate) fn lenient(kept: &Value) -> Self {
        let usual = Self::default();
        let Ok(Value::Object(mut all)) = serde_json::to_value(usual) else { return usual };
        for (name, value) in kept.as_object().unwrap_or(&Map::new()) {
            let Some(before) = all.insert(name.clone(), value.clone()) else {
                all.remove(name);
                continue;
            };
            if serde_json::from_value::<Self>(Value::Object(all.clone())).is_err() {
                all.insert(name.clone(), before);
            }
        }
        serde_json::from_value::<Self>(Value::Object(all)).unwrap_or(usual).in_range()
    }
}

/// The thread's side.
struct Shelf {
    folder: PathBuf,
    answers: Sender<Recent>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Shelf {
    fn work(&self, job: Job) {
        match job {
            Job::Write(text) => {
                // Without it, the next start knows less.
                let _ = fs::create_dir_all(&self.folder);
                let _ = write_atomically(&self.folder.join(FILE), text.as_bytes(), 0);
            }
            Job::Look(files) => {
                self.clear(&files);
                for file in files {
                    let (is_there, picture) = (file.is_file(), read(&self.picture_of(&file)));
                    self.answer(Recent::new(file, is_there, picture.map(Arc::new)));
                }
            }
            Job::Draw(file, root) => {
                let view = Camera::default().view(Vec2::new(PICTURE[0] as f32, PICTURE[1] as f32));
                let Some(picture) = thumbnail::picture(&root, &view, PICTURE, &Cancel::new()) else { return };
                let _ = fs::create_dir_all(self.folder.join(PICTURES));
                if let Some(bytes) = encoded(&picture) {
                    let _ = fs::write(self.picture_of(&file), bytes);
                }
                self.answer(Recent::new(file, true, Some(Arc::new(picture))));
            }
            Job::End(told) => {
                let _ = told.send(());
            }
        }
    }

    fn answer(&self, recent: Recent) {
        if self.answers.send(recent).is_ok() {
            (self.wake)();
        }
    }

    fn picture_of(&self, file: &Path) -> PathBuf {
        let mut hasher = DefaultHasher::new();
        file.hash(&mut hasher);
        self.folder.join(PICTURES).join(format!("{:016x}.png", hasher.finish()))
    }

    /// Removes the pictures of files that are no longer remembered.
    fn clear(&self, files: &[PathBuf]) {
        let wanted: Vec<PathBuf> = files.iter().map(|file| self.picture_of(file)).collect();
        for entry in fs::read_dir(self.folder.join(PICTURES)).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|e| e == "png") && !wanted.contains(&path) {
                let _ = fs::remove_file(path);
            }
        }
    }
}

fn encoded(picture: &ColorImage) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.size[0] as u32, picture.size[1] as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> = picture.pixels.iter().flat_map(|pixel| pixel.to_srgba_unmultiplied()).collect();
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels)).ok()?;
    Some(bytes)
}

/// A picture as [`encoded`] writes it; any other is none.
fn read(file: &Path) -> Option<ColorImage> {
    let bytes = fs::metadata(file).is_ok_and(|data| data.len() <= LARGEST).then(|| fs::read(file))?.ok()?;
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
    let size = [reader.info().width as usize, reader.info().height as usize];
    let mut pixels = vec![0; 4 * PICTURE[0] * PICTURE[1]];
    if size != PICTURE || reader.output_buffer_size() != Some(pixels.len()) {
        return None;
    }
    reader.next_frame(&mut pixels).ok()?;
    Some(ColorImage::from_rgba_unmultiplied(size, &pixels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Habit;
    use blobtree::build::{point, union};
    use std::time::Instant;

    fn open(folder: &Path) -> (Kept, Settings) {
        Kept::open(folder, Arc::new(|| ())).expect("a thread")
    }

    /// Waits until all pictures are there.
    fn wait(kept: &mut Kept, settings: &Settings) {
        let until = Instant::now() + Duration::from_secs(60);
        while kept.recent.iter().any(|recent| recent.picture.is_none()) {
            assert!(Instant::now() < until, "a picture is missing");
            std::thread::sleep(Duration::from_millis(2));
            kept.follow(settings);
        }
    }

    #[test]
    fn settings_and_files_with_their_pictures_come_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let ball: NodeRef = union([point([0., 0., 9.], 9.)]).into();
        let files = ["a.trullo", "b.trullo", "a.trullo"].map(|name| folder.path().join(name));
        fs::write(&files[1], "").expect("there is room");
        let wanted = Settings { habit: Habit::Blender, left_handed: true, scale: 1.5, ..Settings::default() };
        {
            let (mut kept, settings) = open(folder.path());
            assert_eq!(settings, Settings::default());
            files.iter().for_each(|file| kept.remember(file, &ball));
            kept.follow(&wanted);
            wait(&mut kept, &wanted);
        }
        let (mut kept, settings) = open(folder.path());
        assert_eq!(settings, wanted);
        wait(&mut kept, &settings);
        let names: Vec<(&Path, bool)> =
            kept.recent.iter().map(|recent| (&*recent.file, recent.is_there)).collect();
        assert_eq!(names, [(&*files[0], false), (&*files[1], true)]);
        let picture = kept.recent[0].picture.as_ref().expect("waited for");
        assert_eq!(picture.pixels[PICTURE[0] / 2 + PICTURE[0] * (PICTURE[1] / 2)].a(), 255);
        kept.forget(&files[0]);
        kept.follow(&settings);
        drop(kept);
        drop(open(folder.path()));
        let pictures = fs::read_dir(folder.path().join(PICTURES)).expect("it is there").count();
        assert_eq!(pictures, 1);
    }

    #[test]
    fn of_a_broken_file_what_is_legal_is_taken() {
        let folder = tempfile::tempdir().expect("a folder");
        let usual = Settings::default();
        for (text, wanted) in [
            ("", usual),
            ("\u{0}\u{1}", usual),
            ("[1, 2", usual),
            ("{\"settings\": 7, \"recent\": \"x\"}", usual),
            (
                "{\"settings\": {\"left_handed\": true, \"habit\": \"Nobody\", \"overhang\": 1e30, \"x\": 1}, \
                 \"recent\": [3, \"relative\", null]}",
                Settings { left_handed: true, overhang: 70.0, ..usual },
            ),
        ] {
            fs::write(folder.path().join(FILE), text).expect("there is room");
            let (kept, settings) = open(folder.path());
            assert_eq!(settings, wanted, "{text}");
            assert!(kept.recent.is_empty());
        }
    }
}
