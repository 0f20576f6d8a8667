//! What a sketch might become, thought out in the background while the pen is in the air.

use crate::newest::{Answering, Newest};
use crate::thumbnail;
use blobtree::{Document, Drawing, NodePath, NodeRef, Scene, SketchPlane, Template};
use egui::ColorImage;
use glam::{DVec2, Vec2, Vec3};
use sketch::curve::{self, NoOutline};
use sketch::stroke::{Placement, Sketch};
use sketch::suggest::{Outlines, Request, Suggestion, View, suggest};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The size of a picture of a suggestion, pixels: twice its size in points, for fine screens.
pub const PICTURE: [usize; 2] = [112, 88];

/// A sketch over a model, to be thought about.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The strokes, in points of the view.
    pub sketch: Sketch,
    /// How the model was seen when they were drawn.
    pub view: View,
    /// The model.
    pub root: NodeRef,
    /// What is selected.
    pub selected: Option<NodePath>,
    /// The depth of the sketch plane, mm, if somebody has moved it.
    pub depth: Option<f32>,
    /// When the frame began that saw the end of the stroke.
    pub since: Instant,
}

/// What comes to mind, the curve first.
#[derive(Clone, Debug)]
pub enum Thought {
    /// The curves that the strokes mean.
    Curves(Curves),
    /// What the sketch might become.
    Expectations(Expectations),
    /// What one of these looks like.
    Picture(Picture),
}

/// What the model looks like if a suggestion is taken.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Which question it answers.
    pub version: u64,
    /// The place of the suggestion.
    pub suggestion: usize,
    /// As the user sees the model.
    pub image: Arc<ColorImage>,
}

/// The curves that a sketch means, where its strokes are, in points of the view.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    /// Which question it answers.
    pub version: u64,
    /// Closed ones, without repeating the first point.
    pub closed: Vec<Vec<Vec2>>,
    /// Open ones.
    pub open: Vec<Vec<Vec2>>,
}

/// What a sketch might become.
#[derive(Clone, Debug)]
pub struct Expectations {
    /// Which question it answers.
    pub version: u64,
    /// The likeliest first.
    pub suggestions: Vec<Suggestion>,
    /// What they look like, as far as that is known yet.
    pub pictures: Vec<Option<Arc<ColorImage>>>,
    /// The sketch plane.
    pub plane: SketchPlane,
    /// Its depth before the eye, mm.
    pub depth: f32,
    /// Why nothing is suggested that needs a closed outline.
    pub no_outline: Option<NoOutline>,
    /// When the question was asked.
    pub asked: Instant,
    /// How long it took, from question to answer.
    pub took: Duration,
}

/// Thinks about sketches.
#[derive(Debug)]
pub struct Thinker {
    worker: Newest<(u64, Asked), Thought>,
    asked: u64,
}

impl Thinker {
    /// Starts the thread; `wake` is called when something comes to mind.
    ///
    /// Errors: a system without a thread to spare.
    pub fn start(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let worker = Newest::start("sketch", wake, |(version, asked), answering| {
            think(version, &asked, answering);
        })?;
        Ok(Self { worker, asked: 0 })
    }

    /// Asks about a sketch; returns the question's version.
    pub fn ask(&mut self, asked: Asked) -> u64 {
        self.asked += 1;
        self.worker.ask((self.asked, asked));
        self.asked
    }

    /// The sketch is gone: nothing more about it is wanted.
    pub fn stop(&mut self) {
        self.asked += 1;
        self.worker.stop();
    }

    /// Whether this answers the newest question.
    pub fn is_newest(&self, expectations: &Expectations) -> bool {
        expectations.version == self.asked
    }

    /// What came to mind since the last look, on the newest question only.
    pub fn thoughts(&self) -> impl Iterator<Item = Thought> {
        let newest = self.asked;
        self.worker.answers().filter(move |thought| match thought {
            Thought::Curves(curves) => curves.version == newest,
            Thought::Expectations(expectations) => expectations.version == newest,
            Thought::Picture(picture) => picture.version == newest,
        })
    }
}

/// Finds outlines as [`sketch::solve`] does, the curve once.
struct Solver;

impl Outlines for Solver {
    type Reason = NoOutline;

    fn left_out(&self, drawing: &Drawing) -> Result<Vec<usize>, NoOutline> {
        curve::fit(drawing).map(|curve| curve.left_out)
    }

    fn template(&self, drawing: &Drawing) -> Result<Arc<Template>, NoOutline> {
        sketch::solve(drawing, None)
    }
}

fn think(version: u64, asked: &Asked, answering: &Answering<Thought>) {
    let Asked { sketch, view, root, selected, depth, since } = asked;
    answering.give(Thought::Curves(curves(version, sketch, &view.placement(view.depth(Vec3::ZERO)))));
    if answering.cancel.is_cancelled() {
        return;
    }
    let request = Request { sketch, view: *view, root, selected: selected.as_ref(), depth: *depth };
    let found = suggest(&request, &Solver);
    answering.give(Thought::Expectations(Expectations {
        version,
        pictures: vec![None; found.suggestions.len()],
        suggestions: found.suggestions.clone(),
        plane: found.plane,
        depth: found.depth,
        no_outline: found.no_outline,
        asked: *since,
        took: since.elapsed(),
    }));
    pictures(version, asked, &found.suggestions, answering);
}

/// Draws what the suggestions would make of the model.
fn pictures(version: u64, asked: &Asked, suggestions: &[Suggestion], answering: &Answering<Thought>) {
    let Ok(document) = Document::new(Scene::new(asked.root.clone())) else { return };
    for (suggestion, suggested) in suggestions.iter().enumerate() {
        let Ok(scene) = document.preview(suggested.command.clone()) else { continue };
        if answering.cancel.is_cancelled() {
            return;
        }
        let image = thumbnail::picture(&scene.root, &asked.view, PICTURE, &answering.cancel);
        if let Some(image) = image.map(Arc::new) {
            answering.give(Thought::Picture(Picture { version, suggestion, image }));
        }
    }
}

/// The curves of a sketch; where they come to lie in the model does not matter for them.
fn curves(version: u64, sketch: &Sketch, placement: &Placement) -> Curves {
    let drawing = placement.drawing(sketch);
    let seen = |line: Vec<DVec2>| line.into_iter().map(|p| placement.px_from_mm(p.as_vec2())).collect();
    let closed =
        curve::fit(&drawing).unwrap_or_default().contours.into_iter().map(|c| seen(c.points)).collect();
    Curves { version, closed, open: curve::fit_open(&drawing).into_iter().map(seen).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::workbench::Workbench;
    use sketch::stroke::Stroke;
    use std::f32::consts::TAU;

    const MIDDLE: Vec2 = Vec2::new(400.0, 300.0);

    fn circle(radius: f32) -> Stroke {
        Stroke::through((0..=60).map(|i| MIDDLE + radius * Vec2::from_angle(TAU * i as f32 / 60.0)))
    }

    #[test]
    fn a_circle_on_an_empty_page_shows_its_curve_and_then_what_it_might_become() {
        let mut thinker = Thinker::start(Arc::new(|| ())).expect("a thread");
        thinker.ask(Asked {
            sketch: Sketch::from_strokes([&circle(100.0)]),
            view: Camera::default().view(2.0 * MIDDLE),
            root: Workbench::empty_page().root,
            selected: None,
            depth: None,
            since: Instant::now(),
        });
        let mut thoughts = Vec::new();
        let until = Instant::now() + Duration::from_secs(60);
        while thoughts.len() < 5 {
            assert!(Instant::now() < until, "nothing comes to mind");
            thoughts.extend(thinker.thoughts());
            std::thread::sleep(Duration::from_millis(2));
        }
        let [Thought::Curves(curves), Thought::Expectations(expectations), pictures @ ..] = &thoughts[..]
        else {
            panic!("{thoughts:?}")
        };
        assert!(curves.closed.len() == 1 && curves.open.is_empty());
        assert!(curves.closed[0].iter().all(|p| (p.distance(MIDDLE) - 100.0).abs() < 1.0));
        let names: Vec<&str> =
            expectations.suggestions.iter().map(|suggestion| suggestion.icon.id()).collect();
        assert_eq!(names, ["inflate", "sweep", "revolve"]);
        let of = pictures.iter().filter_map(|thought| match thought {
            Thought::Picture(picture) => Some(picture.suggestion),
            _ => None,
        });
        assert_eq!(of.collect::<Vec<_>>(), [0, 1, 2]);
    }
}
