//! Work on files beside the running modeler: opening, saving, exporting. Nothing here lets a frame wait.

use crate::modeler::Modeler;
use polygonizer::Cancel;
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

/// Trees are walked by recursion; as deep as scenes may be, this is plenty.
const STACK_BYTES: usize = 32 << 20;

/// What is told of an errand that has been stopped and has not come to its end yet.
pub const STOPPING: &str = "stopping";

/// Why an errand has no result.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Undone {
    /// The user stopped it. Nothing was written.
    #[error("stopped")]
    Stopped,
    /// It could not be done, in words for the user. Nothing was written.
    #[error("{0}")]
    Failed(String),
}

/// How far an errand is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// What is being done now, in words for the user.
    pub step: String,
    /// How much of that is done, from 0 to 1, if that is known.
    pub share: Option<f32>,
}

/// How an errand tells how far it is, and hears that it is to stop.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// Set when nobody wants the result any more.
    pub cancel: Cancel,
    progress: Arc<Mutex<Progress>>,
}

impl Watch {
    /// Tells what is being done, and how much of it is done if that is known.
    pub fn report(&self, step: &str, share: Option<f32>) {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        if progress.step != step {
            progress.step = step.into();
        }
        progress.share = share;
    }

    fn progress(&self) -> Progress {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// What an errand is for. Those of a kind are done one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Reading what will take the table. A newer one takes the place of an older one.
    Open,
    /// Reading what is added to the document.
    Add,
    /// Writing the scene.
    Save,
    /// Writing a mesh.
    Export,
}

impl Kind {
    /// Whether it changes files, so that it must come to an end before the program may.
    fn writes(self) -> bool {
        matches!(self, Self::Save | Self::Export)
    }
}

/// What is done in a frame with the result of an errand.
pub type Arrive = Box<dyn FnOnce(&mut Modeler) + Send>;

type Work = Box<dyn FnOnce(&Watch) -> Arrive + Send>;

enum State {
    Waiting(Work),
    Running(Receiver<Arrive>),
}

struct Errand {
    kind: Kind,
    title: String,
    watch: Watch,
    state: State,
}

impl Errand {
    fn progress(&self) -> Progress {
        match self.watch.cancel.is_cancelled() {
            true => Progress { step: STOPPING.into(), share: None },
            false => self.watch.progress(),
        }
    }

    fn start(&mut self, wake: Arc<dyn Fn() + Send + Sync>) {
        let (sender, receiver) = mpsc::channel();
        let State::Waiting(work) = std::mem::replace(&mut self.state, State::Running(receiver)) else {
            return;
        };
        let watch = self.watch.clone();
        let thread = thread::Builder::new().name("errand".into()).stack_size(STACK_BYTES);
        // Without a thread, the other end is gone, and that is told.
        let _ = thread.spawn(move || {
            // Nobody waits for what was stopped.
            let _ = sender.send(work(&watch));
            drop(sender);
            wake();
        });
    }
}

/// All errands that are under way.
pub struct Errands {
    list: Vec<Errand>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Errands {
    /// None yet. `wake` is called when one has ended.
    pub fn new(wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self { list: Vec::new(), wake }
    }

    /// Has `work` done on a thread of its own, after those of its kind that are under way. `title` is what the user
    /// reads meanwhile, such as "Opening ball.stl".
    pub fn begin(
        &mut self,
        kind: Kind,
        title: impl Into<String>,
        work: impl FnOnce(&Watch) -> Arrive + Send + 'static,
    ) {
        if kind == Kind::Open {
            self.stop_all(|errand| errand.kind == Kind::Open);
        }
        let state = State::Waiting(Box::new(work));
        self.list.push(Errand { kind, title: title.into(), watch: Watch::default(), state });
        self.go_on();
    }

    /// Begins those whose turn it is.
    fn go_on(&mut self) {
        for i in 0..self.list.len() {
            let kind = self.list[i].kind;
            let is_first = self.list[..i].iter().all(|before| before.kind != kind);
            if is_first && matches!(self.list[i].state, State::Waiting(_)) {
                self.list[i].start(self.wake.clone());
            }
        }
    }

    /// The results since the last look. While `holds_back`, what would take the table waits.
    pub fn arrived(&mut self, holds_back: bool) -> Vec<Arrive> {
        let mut arrived = Vec::new();
        self.list.retain(|errand| {
            let State::Running(receiver) = &errand.state else { return true };
            if holds_back && !errand.kind.writes() {
                return true;
            }
            match receiver.try_recv() {
                Ok(arrive) => arrived.push(arrive),
                Err(TryRecvError::Empty) => return true,
                Err(TryRecvError::Disconnected) => {
                    let told = format!("{}: this could not be done; try again", errand.title);
                    arrived.push(Box::new(move |modeler| modeler.notices.warn(told)));
                }
            }
            false
        });
        self.go_on();
        arrived
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether a file is being written, or will be.
    pub fn is_writing(&self) -> bool {
        self.list.iter().any(|errand| errand.kind.writes())
    }

    /// Whether the scene is being saved, or will be.
    pub fn is_saving(&self) -> bool {
        self.list.iter().any(|errand| errand.kind == Kind::Save)
    }

    /// What the user reads of each, the oldest first.
    pub fn told(&self) -> impl Iterator<Item = (&str, Progress)> {
        self.list.iter().map(|errand| (&*errand.title, errand.progress()))
    }

    /// Stops one, by its place.
    pub fn stop(&mut self, place: usize) {
        let mut at = 0..;
        self.stop_all(|_| at.next() == Some(place));
    }

    /// Stops all.
    pub fn stop_everything(&mut self) {
        self.stop_all(|_| true);
    }

    /// Stops all that is being read.
    pub fn stop_reading(&mut self) {
        self.stop_all(|errand| !errand.kind.writes());
    }

    /// Those that write are kept until they have come to an end.
    fn stop_all(&mut self, mut which: impl FnMut(&Errand) -> bool) {
        self.list.retain(|errand| {
            let stops = which(errand);
            if stops {
                errand.watch.cancel.cancel();
            }
            !stops || errand.kind.writes() && matches!(errand.state, State::Running(_))
        });
        self.go_on();
    }
}

impl Drop for Errands {
    fn drop(&mut self) {
        self.stop_everything();
    }
}
