//! How long the user waits: one line of JSON for each wait that ended, for `--trace FILE`.
//!
//! Every wait begins with the frame that took in what the user did, and ends when the frame with the answer is
//! painted. Waits that belong to each other and have the user's own choice between them are lines of their own: a
//! stroke's solid takes `stroke_to_suggestions` and `choice_to_solid` together.

use serde_json::json;
use std::io::{self, Write};
use std::time::{Duration, Instant};

/// What was waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait {
    /// From a place of the pen to its stroke.
    PenToStroke,
    /// From the end of a stroke to what it may become.
    StrokeToSuggestions,
    /// From the choice of a suggestion to the first solid with it.
    ChoiceToSolid,
    /// From a place of the hand that drags a handle or a number to the solid with it.
    DragToSolid,
}

impl Wait {
    fn name(self) -> &'static str {
        match self {
            Self::PenToStroke => "pen_to_stroke",
            Self::StrokeToSuggestions => "stroke_to_suggestions",
            Self::ChoiceToSolid => "choice_to_solid",
            Self::DragToSolid => "drag_to_solid",
        }
    }
}

/// A wait whose answer is in the present frame.
#[derive(Clone, Copy, Debug)]
struct Ending {
    wait: Wait,
    since: Instant,
    geometry: Option<Duration>,
}

/// A frame that was shown.
#[derive(Clone, Copy, Debug)]
struct Frame {
    began: Instant,
    /// How long the interface took to say what is to be painted.
    took: Duration,
    /// Whether geometry was being computed beside it.
    computing: bool,
}

/// Writes down how long the user waits.
pub struct Trace {
    out: Box<dyn Write + Send>,
    start: Instant,
    ending: Vec<Ending>,
    last: Option<Frame>,
    failed: Option<io::Error>,
}

impl Trace {
    /// One that writes to `out`.
    pub fn new(out: Box<dyn Write + Send>) -> Self {
        Self { out, start: Instant::now(), ending: Vec::new(), last: None, failed: None }
    }

    /// A wait ends with the present frame. `geometry` is how much of it the background threads took.
    pub fn ends(&mut self, wait: Wait, since: Instant, geometry: Option<Duration>) {
        self.ending.push(Ending { wait, since, geometry });
    }

    /// The last frame took so long with all that is painted; to be called before the next one, by whoever knows.
    pub fn painted(&mut self, took: Duration) {
        if let Some(frame) = &mut self.last {
            frame.took = frame.took.max(took);
        }
    }

    /// The present frame is about to be shown.
    pub fn frame(&mut self, began: Instant, computing: bool) {
        self.last = Some(Frame { began, took: began.elapsed(), computing });
    }

    /// Writes down the last frame and the waits that it ended.
    ///
    /// Returns an error once: the first that the file gave. After it, nothing is written any more.
    pub fn write(&mut self) -> Option<io::Error> {
        let frame = self.last.take()?;
        let ms = |duration: Duration| (duration.as_secs_f64() * 1e5).round() / 100.0;
        let shown = frame.began + frame.took;
        let mut text = String::new();
        let at = ms(frame.began - self.start);
        for Ending { wait, since, geometry } in self.ending.drain(..) {
            let mut line = json!({ "what": wait.name(), "at_ms": at, "ms": ms(shown - since) });
            if let Some(geometry) = geometry {
                line["geometry_ms"] = ms(geometry).into();
            }
            text += &format!("{line}\n");
        }
        let line =
            json!({ "what": "frame", "at_ms": at, "ms": ms(frame.took), "computing": frame.computing });
        text += &format!("{line}\n");
        if self.failed.is_some() {
            return None;
        }
        let error = self.out.write_all(text.as_bytes()).and_then(|()| self.out.flush()).err()?;
        self.failed = Some(io::Error::from(error.kind()));
        Some(error)
    }
}

impl std::fmt::Debug for Trace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Trace").field("start", &self.start).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read as _, Seek as _};

    #[test]
    fn a_wait_ends_when_the_frame_with_its_answer_is_painted() {
        let mut file = tempfile::tempfile().expect("there is room");
        let mut trace = Trace::new(Box::new(file.try_clone().expect("one more handle")));
        let since = Instant::now();
        let began = since + Duration::from_millis(0);
        trace.ends(Wait::DragToSolid, since, Some(Duration::from_millis(3)));
        trace.frame(began, true);
        trace.painted(Duration::from_millis(250));
        assert!(trace.write().is_none());
        let mut written = String::new();
        file.rewind().and_then(|()| file.read_to_string(&mut written)).expect("it was written");
        let lines: Vec<serde_json::Value> =
            written.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert_eq!((&lines[0]["what"], &lines[0]["ms"]), (&json!("drag_to_solid"), &json!(250.0)));
        assert_eq!(lines[0]["geometry_ms"], json!(3.0));
        assert_eq!((&lines[1]["what"], &lines[1]["computing"]), (&json!("frame"), &json!(true)));
    }
}
