//! A progress bar on the terminal for stages that take longer than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt;
use std::io::IsTerminal;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Stages shorter than this are not worth a bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the bar is drawn.
const TICK: Duration = Duration::from_millis(100);
/// Steps of a full bar.
const STEPS: u64 = 1000;

/// What is being done now.
#[derive(Debug)]
struct Stage {
    name: &'static str,
    since: Instant,
    /// From 0 to 1; none if the stage cannot tell.
    share: Option<f32>,
}

/// Who else hears of a stage and how much of it is done.
type Listener = Box<dyn Fn(&'static str, Option<f32>) + Send + Sync>;

/// Watches the stages of the work and draws a bar for the long ones. Silent unless stderr is a terminal.
pub struct Meter {
    stage: Arc<Mutex<Option<Stage>>>,
    listener: Option<Listener>,
    /// Ends the drawing when dropped.
    drawer: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Meter {
    /// A meter that draws if it is `wanted` and there is a terminal to draw on.
    pub fn new(wanted: bool) -> Self {
        let stage = Arc::new(Mutex::new(None));
        let drawer = (wanted && std::io::stderr().is_terminal()).then(|| {
            let (end, ended) = mpsc::channel();
            let seen = Arc::clone(&stage);
            (end, std::thread::spawn(move || draw(&seen, &ended)))
        });
        Self { stage, listener: None, drawer }
    }

    /// A meter that draws nothing, but tells somebody of each stage as it goes on.
    pub fn telling(listener: impl Fn(&'static str, Option<f32>) + Send + Sync + 'static) -> Self {
        let stage = Arc::default();
        Self { stage, listener: Some(Box::new(listener)), drawer: None }
    }

    /// A stage begins.
    pub fn begin(&self, name: &'static str) {
        self.set(Some(Stage { name, since: Instant::now(), share: None }));
        if let Some(listener) = &self.listener {
            listener(name, None);
        }
    }

    /// The stage ends.
    pub fn end(&self) {
        self.set(None);
    }

    /// How much of the stage is done, from 0 to 1; less than was told before is ignored.
    pub fn report(&self, share: f32) {
        if self.drawer.is_none() && self.listener.is_none() {
            return;
        }
        if let Some(stage) = &mut *self.stage.lock().unwrap_or_else(PoisonError::into_inner) {
            let share = stage.share.map_or(share, |before| before.max(share));
            stage.share = Some(share);
            if let Some(listener) = &self.listener {
                listener(stage.name, Some(share));
            }
        }
    }

    fn set(&self, stage: Option<Stage>) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
    }
}

impl fmt::Debug for Meter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Meter").field("stage", &self.stage).finish_non_exhaustive()
    }
}

impl Drop for Meter {
    fn drop(&mut self) {
        if let Some((end, drawer)) = self.drawer.take() {
            drop(end);
            // A bar that could not be drawn is no reason to fail.
            let _ = drawer.join();
        }
    }
}

/// Draws until the other end of `ended` is gone.
fn draw(stage: &Mutex<Option<Stage>>, ended: &mpsc::Receiver<()>) {
    let style = |template| ProgressStyle::with_template(template).expect("the templates below are right");
    let known = style("{msg:>10} [{bar:40}] {percent:>3} %").progress_chars("=> ");
    let unknown = style("{msg:>10} {spinner}");
    let mut shown: Option<ProgressBar> = None;
    while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
        match &*stage.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(stage) if stage.since.elapsed() > PATIENCE => {
                let target = ProgressDrawTarget::stderr;
                let bar = shown.get_or_insert_with(|| ProgressBar::with_draw_target(Some(STEPS), target()));
                bar.set_style(if stage.share.is_some() { known.clone() } else { unknown.clone() });
                bar.set_message(stage.name);
                bar.set_position((f64::from(stage.share.unwrap_or(0.0)) * STEPS as f64) as u64);
                bar.tick();
            }
            _ => shown.take().into_iter().for_each(|bar| bar.finish_and_clear()),
        }
    }
    shown.into_iter().for_each(|bar| bar.finish_and_clear());
}
