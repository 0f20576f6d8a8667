//! The solid as it is drawn, made in the background: coarse at once, fine when nothing else is to do.
//!
//! A coarse solid is made to its end and shown even if the hand has moved on meanwhile: a drag whose every place stops
//! the work on the one before would show nothing until the hand rests.

mod level;

use crate::desk::Bake;
use crate::newest::{Answering, Newest};
use crate::seams::{Ground, seams};
use crate::stage::Line;
use blobtree::{Aabb, BakeStore, Field, NodeRef, Owners, Palette, Tree, solid_box};
use glam::Vec3;
use level::{Level, SLACK};
use polygonizer::{Cancel, Surface, VertexKind};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long nothing new must be asked before the fine surface is begun.
const REST: Duration = Duration::from_millis(150);

/// If the seams of the last coarse solid took no longer than this, the next ones come with their solid, so that they
/// move with what is dragged: twice what the seams of most examples take, a fifth of what those of the forest do.
const WITH_SOLID: Duration = Duration::from_millis(20);

/// How often edges are halved in looking for seams, of what is shown at once, and of what is shown when there is time: a
/// figure of 100 blended nodes has a seam in every third cell, and all halvings together take longer than its surface.
const HALVINGS: [usize; 2] = [2, 5];

/// How long seams fade whose own take longer.
const FADES: Duration = Duration::from_millis(300);

/// Points that are coloured together.
const TOGETHER: usize = 256;

/// A corner of a triangle, as the graphics card takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Corner {
    /// mm.
    pub position: [f32; 3],
    /// Unit, outwards; that of the triangle where it meets a sharp edge.
    pub normal: [f32; 3],
    /// sRGB, and the level: 0 for the coarse surface, 1 for the fine one.
    pub color: [u8; 4],
}

/// Why a solid is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asking {
    /// The user has chosen what a sketch becomes.
    Choice,
    /// The user is dragging something.
    Drag,
    /// Anything else.
    Other,
}

/// A solid ready to be drawn.
#[derive(Debug)]
pub struct Solid {
    /// Which of the solids asked for it is.
    pub version: u64,
    /// Three for each triangle, counter-clockwise seen from outside.
    pub corners: Vec<Corner>,
    /// Around it, mm; empty without any.
    pub bounds: Aabb,
    /// The size of its cells, mm.
    pub cell: f32,
    /// Whether it is the finest that is made.
    pub is_fine: bool,
    /// Whether its cells are larger than usual, because it would have too many triangles.
    pub is_coarsened: bool,
    /// How many of its support-free nodes are shown as drawn.
    pub unconstrained: usize,
    /// Why it was asked for.
    pub asking: Asking,
    /// When the frame began that asked for it.
    pub asked: Instant,
    /// How long the work on it took.
    pub took: Duration,
}

/// Where one part of a solid ends and another begins.
#[derive(Debug)]
struct Seams {
    version: u64,
    is_fine: bool,
    lines: Vec<Line>,
}

/// What comes of a question: a solid, with its seams if they are quick; else they come later.
#[derive(Debug)]
enum Made {
    Solid(Solid, Option<Seams>),
    Seams(Seams),
}

/// A tree to be drawn.
#[derive(Clone, Debug)]
struct Question {
    version: u64,
    root: NodeRef,
    has_seams: bool,
    asking: Asking,
    asked: Instant,
}

/// Makes solids of trees.
#[derive(Debug)]
pub struct SolidMaker {
    worker: Newest<Question, Made>,
    asked: u64,
    /// Whether what was asked last is to have seams.
    has_seams: bool,
    seams: Option<Seams>,
    /// Since when there is a newer solid than the one the seams are of.
    outdated: Option<Instant>,
    /// Solids before this one are of a document that is gone.
    first: u64,
}

impl SolidMaker {
    /// Starts the thread; `wake` is called when a solid is ready. Fine solids have their support-free nodes baked by
    /// `bake`, if there is one.
    ///
    /// Errors: a system without a thread to spare.
    pub fn start(wake: Arc<dyn Fn() + Send + Sync>, bake: Option<Bake>) -> std::io::Result<Self> {
        let mut maker = Maker {
            levels: [0, 1].map(Level::new),
            extent: Aabb::EMPTY,
            reach: 0.0,
            bakes: BakeStore::new(),
            bake,
            sewing: Duration::ZERO,
        };
        let worker = Newest::start("solid", wake, move |question: Question, answering| {
            maker.make(&question, answering);
        })?;
        Ok(Self { worker, asked: 0, has_seams: false, seams: None, outdated: None, first: 0 })
    }

    /// Asks for the solid of a tree, with its seams or without, in a frame that began `now`; returns its version.
    pub fn ask(&mut self, root: &NodeRef, has_seams: bool, asking: Asking, now: Instant) -> u64 {
        self.asked += 1;
        self.has_seams = has_seams;
        let root = root.clone();
        self.worker.ask(Question { version: self.asked, root, has_seams, asking, asked: now });
        self.asked
    }

    /// The newest solid since the last look.
    pub fn ready(&mut self) -> Option<Solid> {
        let mut newest = None;
        for made in self.worker.answers() {
            match made {
                Made::Solid(solid, seams) => {
                    newest = Some(solid);
                    self.seams = seams.or(self.seams.take());
                }
                Made::Seams(seams) => self.seams = Some(seams),
            }
        }
        newest.filter(|solid| solid.version >= self.first).inspect(|solid| {
            let is_outdated = self.seams.as_ref().is_some_and(|seams| seams.version != solid.version);
            self.outdated = is_outdated.then(|| self.outdated.unwrap_or_else(Instant::now));
        })
    }

    /// The seams of a solid, as far as they are known, and how strongly they show, from 0 to 1: those of the solid
    /// before fade until its own are there.
    pub fn seams(&self, solid: &Solid) -> (&[Line], f32) {
        let Some(seams) = &self.seams else { return (&[], 0.0) };
        let shown = match self.outdated {
            _ if seams.version == solid.version => 1.0,
            Some(since) if seams.version >= self.first => {
                1.0 - since.elapsed().as_secs_f32() / FADES.as_secs_f32()
            }
            _ => 0.0,
        };
        if shown > 0.0 { (&seams.lines, shown) } else { (&[], 0.0) }
    }

    /// Nothing that was asked for so far is wanted any more.
    pub fn forget(&mut self) {
        self.first = self.asked + 1;
    }

    /// Whether everything asked for so far is there in `shown` as fine as it gets.
    pub fn is_done(&self, shown: Option<&Solid>) -> bool {
        let is_newest = |seams: &Seams| seams.version == self.asked && seams.is_fine;
        let has_seams = !self.has_seams || self.seams.as_ref().is_some_and(is_newest);
        has_seams && shown.is_some_and(|solid| solid.version == self.asked && solid.is_fine)
    }
}

/// What makes solids.
struct Maker {
    levels: [Level; 2],
    /// Around the last solid, by which cells are chosen.
    extent: Aabb,
    /// How far the influence of what was last drawn reached, along its longest side, mm.
    reach: f32,
    bakes: BakeStore,
    bake: Option<Bake>,
    /// How long the seams of the last coarse solid took.
    sewing: Duration,
}

impl Maker {
    /// Makes one level after the other.
    fn make(&mut self, question: &Question, answering: &Answering<Made>) {
        let mut began = Instant::now();
        let tree = Tree::new(&question.root);
        let palette = Palette::new(&question.root, &BakeStore::new());
        self.choose_extent(&tree);
        let [coarse, fine] = &mut self.levels;
        if coarse.follow(&question.root, &tree, self.extent, &answering.closed).is_none() {
            return;
        }
        let Some((_, surface)) = &coarse.surface else { return };
        let is_coarsened = coarse.is_coarsened(surface, self.extent);
        let drawn = Solid { is_coarsened, ..draw(surface, &palette, question, false) };
        self.extent = drawn.bounds;
        let unconstrained = tree.unconstrained();
        let mut sewing = Duration::ZERO;
        let mut sew_coarse = |cancel: &Cancel| {
            let began = Instant::now();
            let seams = sew(surface, &BakeStore::new(), question, false, cancel);
            sewing = began.elapsed();
            seams
        };
        let is_quick = self.sewing <= WITH_SOLID;
        let seams = if is_quick { sew_coarse(&answering.closed) } else { None };
        answering.give_late(Made::Solid(Solid { unconstrained, took: began.elapsed(), ..drawn }, seams));
        if !is_quick && let Some(seams) = sew_coarse(&answering.cancel) {
            answering.give(Made::Seams(seams));
        }
        self.sewing = sewing;
        if !rests(&answering.cancel) {
            return;
        }
        began = Instant::now();
        if let Some(bake) = self.bake.as_mut().filter(|_| unconstrained > 0)
            && bake(&question.root, &mut self.bakes, &answering.cancel)
        {
            // A change below such a node may change all of it, so its surface is made anew.
            fine.surface = None;
            let tree = self.bakes.compile(&question.root);
            let palette = Palette::new(&question.root, &self.bakes);
            let Some(surface) = fine.build(&tree, self.extent, &answering.cancel) else { return };
            let is_coarsened = fine.is_coarsened(&surface, self.extent);
            let drawn = Solid { is_coarsened, ..draw(&surface, &palette, question, true) };
            let unconstrained = tree.unconstrained();
            answering.give(Made::Solid(Solid { unconstrained, took: began.elapsed(), ..drawn }, None));
            let seams = sew(&surface, &self.bakes, question, true, &answering.cancel);
            seams.into_iter().for_each(|seams| answering.give(Made::Seams(seams)));
            return;
        }
        if fine.follow(&question.root, &tree, self.extent, &answering.cancel).is_none() {
            return;
        }
        let Some((_, surface)) = &fine.surface else { return };
        let is_coarsened = fine.is_coarsened(surface, self.extent);
        let drawn = Solid { is_coarsened, ..draw(surface, &palette, question, true) };
        self.extent = drawn.bounds;
        answering.give(Made::Solid(Solid { unconstrained, took: began.elapsed(), ..drawn }, None));
        let seams = sew(surface, &BakeStore::new(), question, true, &answering.cancel);
        seams.into_iter().for_each(|seams| answering.give(Made::Seams(seams)));
    }
}

impl Maker {
    /// Measures the solid anew if its size may be quite another one than that of the last: cells chosen for a ball of
    /// 5 mm would make millions of triangles of one of 50 mm.
    fn choose_extent(&mut self, tree: &Tree) {
        let reach = tree.support().size().max_element();
        let is_alike = (1.0 / SLACK..=SLACK).contains(&(reach / self.reach));
        if self.extent.is_empty() || !is_alike {
            let solid = solid_box(tree);
            self.extent = if solid.is_empty() { tree.support() } else { solid };
        }
        self.reach = reach;
    }
}

/// Waits a little; whether nothing new was asked.
fn rests(cancel: &Cancel) -> bool {
    let until = Instant::now() + REST;
    while Instant::now() < until && !cancel.is_cancelled() {
        std::thread::sleep(Duration::from_millis(5));
    }
    !cancel.is_cancelled()
}

/// Makes the seams, if they are wanted; none if it was cancelled.
fn sew(
    surface: &Surface,
    bakes: &BakeStore,
    question: &Question,
    is_fine: bool,
    cancel: &Cancel,
) -> Option<Seams> {
    if !question.has_seams || cancel.is_cancelled() {
        return None;
    }
    let (mesh, normals) = (surface.mesh(), surface.normals());
    let ground = Ground {
        positions: &mesh.positions,
        normals: &normals,
        triangles: &mesh.triangles,
        cell: surface.cell().mm(),
        halvings: HALVINGS[usize::from(is_fine)],
    };
    let owners = Owners::new(&question.root, bakes);
    let lines = seams(&question.root, &owners, ground, cancel)?;
    Some(Seams { version: question.version, is_fine, lines })
}

fn draw(surface: &Surface, palette: &Palette, question: &Question, is_fine: bool) -> Solid {
    let (mesh, normals, kinds) = (surface.mesh(), surface.normals(), surface.kinds());
    let colors: Vec<[u8; 3]> = mesh
        .positions
        .par_chunks(TOGETHER)
        .map_init(|| palette.painter(), |painter, points| painter.colors(points))
        .flatten_iter()
        .collect();
    let level = u8::from(is_fine);
    let corners = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        let flat = (b - a).cross(c - a).normalize_or_zero();
        triangle.map(|v| {
            let v = v as usize;
            let normal =
                if kinds[v] == VertexKind::Smooth && normals[v] != Vec3::ZERO { normals[v] } else { flat };
            let [r, g, b] = colors[v];
            Corner {
                position: mesh.positions[v].to_array(),
                normal: normal.to_array(),
                color: [r, g, b, level],
            }
        })
    };
    Solid {
        version: question.version,
        corners: mesh.triangles.par_iter().flat_map_iter(corners).collect(),
        bounds: Aabb::of_points(mesh.positions.iter().copied()),
        cell: surface.cell().mm(),
        is_fine,
        is_coarsened: false,
        unconstrained: 0,
        asking: question.asking,
        asked: question.asked,
        took: Duration::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::level::MOST_TRIANGLES;
    use super::*;
    use blobtree::build::{point, union};

    /// Waits for the fine solid of this version.
    fn fine(maker: &mut SolidMaker, version: u64) -> Solid {
        let until = Instant::now() + Duration::from_secs(60);
        loop {
            match maker.ready() {
                Some(solid) if solid.version == version && solid.is_fine => return solid,
                _ => assert!(Instant::now() < until, "it never came"),
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn a_solid_that_follows_a_drag_is_the_one_that_is_made_anew() {
        let two = |x: f32| -> NodeRef { union([point([0., 0., 10.], 10.), point([x, 0., 10.], 8.)]).into() };
        let mut following = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let first = following.ask(&two(12.0), true, Asking::Other, Instant::now());
        fine(&mut following, first);
        let after = two(13.0);
        let version = following.ask(&after, true, Asking::Drag, Instant::now());
        let followed = fine(&mut following, version);
        let mut anew = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version = anew.ask(&after, true, Asking::Other, Instant::now());
        let made = fine(&mut anew, version);
        // The cells were chosen for the solid before the drag.
        let ends = |solid: &Solid| [solid.bounds.min, solid.bounds.max];
        for (a, b) in ends(&followed).into_iter().zip(ends(&made)) {
            assert!(a.distance(b) < 0.05, "{a} {b}");
        }
    }

    /// Asks for a new place every millisecond, which is less than any solid takes, until five solids are as they should be.
    fn drag(
        maker: &mut SolidMaker,
        at: impl Fn(f32) -> NodeRef,
        is_good: impl Fn(&SolidMaker, &Solid) -> bool,
    ) {
        let until = Instant::now() + Duration::from_secs(60);
        let mut good = 0;
        for step in 1_u16.. {
            assert!(Instant::now() < until, "{good} solids in {step} steps");
            maker.ask(&at(0.01 * f32::from(step)), true, Asking::Drag, Instant::now());
            let solid = maker.ready();
            good += usize::from(solid.is_some_and(|solid| is_good(maker, &solid)));
            if good == 5 {
                break;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_drag_that_never_rests_is_followed() {
        let at = |x: f32| -> NodeRef { union([point([x, 0., 10.], 10.), point([0., 0., 30.], 8.)]).into() };
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        drag(&mut maker, at, |_, _| true);
    }

    #[test]
    fn seams_move_with_what_is_dragged_and_fade_where_they_take_too_long() {
        let two = |x: f32| -> NodeRef { union([point([0., 0., 10.], 10.), point([x, 0., 10.], 8.)]).into() };
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version = maker.ask(&two(12.0), true, Asking::Other, Instant::now());
        fine(&mut maker, version);
        drag(
            &mut maker,
            |by| two(12.0 + by),
            |maker, solid| {
                let (lines, shown) = maker.seams(solid);
                // On a busy machine they may take long once, and fade.
                assert!(!lines.is_empty(), "{shown}");
                shown == 1.0
            },
        );
        // Seams of another solid are gone after a while.
        let version = maker.ask(&two(20.0), false, Asking::Drag, Instant::now());
        let solid = fine(&mut maker, version);
        let (lines, shown) = maker.seams(&solid);
        assert!(!lines.is_empty() && (0.0..1.0).contains(&shown), "{} lines, {shown}", lines.len());
        std::thread::sleep(FADES);
        assert!(maker.seams(&solid).0.is_empty());
    }

    #[test]
    fn a_solid_that_grows_at_once_to_a_hundred_times_its_size_has_no_more_triangles() {
        let ball = |radius: f32| -> NodeRef { union([point([0., 0., radius], radius)]).into() };
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version = maker.ask(&ball(5.0), false, Asking::Other, Instant::now());
        let small = fine(&mut maker, version).corners.len();
        for radius in [500.0, 2.0] {
            let version = maker.ask(&ball(radius), false, Asking::Other, Instant::now());
            let ratio = fine(&mut maker, version).corners.len() as f32 / small as f32;
            assert!((0.4..2.5).contains(&ratio), "{ratio} times as many for {radius} mm");
        }
    }

    #[test]
    fn a_model_with_surfaces_everywhere_is_shown_in_larger_cells_and_a_simple_one_after_it_is_not() {
        let places = (0..1000_u16).map(|i| [i % 10, i / 10 % 10, i / 100].map(f32::from));
        let balls = places.map(|[x, y, z]| point([10. * x, 10. * y, 10. * z], 4.8)).collect::<Vec<_>>();
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version = maker.ask(&union(balls).into(), false, Asking::Other, Instant::now());
        let solid = fine(&mut maker, version);
        let triangles = solid.corners.len() / 3;
        assert!(solid.is_coarsened && triangles <= MOST_TRIANGLES[1], "{triangles}");
        assert!(triangles > MOST_TRIANGLES[1] / 4, "{triangles}");
        let mut one = |radius: f32| {
            let version =
                maker.ask(&union([point([0.; 3], radius)]).into(), false, Asking::Other, Instant::now());
            fine(&mut maker, version)
        };
        one(50.0);
        assert!(!one(51.0).is_coarsened);
    }

    #[test]
    fn nothing_is_drawn_of_an_empty_page() {
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version =
            maker.ask(&crate::workbench::Workbench::empty_page().root, true, Asking::Other, Instant::now());
        let solid = fine(&mut maker, version);
        assert!(solid.corners.is_empty() && solid.bounds.is_empty());
    }
}
