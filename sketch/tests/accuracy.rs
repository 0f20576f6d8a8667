//! Curves against the shapes that were drawn: every shape by every hand, as one table.
//!
//! `cargo test -p sketch --test accuracy -- --nocapture` prints it.

mod drawn;

use drawn::{Hand, Shape, draw, hausdorff, loops, pieces, shapes, size};
use glam::DVec2;
use sketch::curve::fit;

const COUNTS: [usize; 7] = [30, 60, 120, 250, 500, 1000, 2000];

/// Distance between curve and truth, of the shape's size; none with pieces or holes too many or too few.
fn off(shape: &Shape, hand: Hand) -> Option<f64> {
    let truth: Vec<Vec<DVec2>> =
        shape.loops.iter().map(|points| points.iter().map(|&p| 40. * p).collect()).collect();
    let curve = fit(&draw(shape, hand, |p| 40. * p)).ok()?;
    let sound = pieces(&curve) == (shape.outlines, shape.holes);
    sound.then(|| hausdorff(&truth, &loops(&curve)) / (40. * size(shape)))
}

/// The worst over seeds and both directions; none where one has wrong pieces.
fn worst(shape: &Shape, samples: usize, noise: f64, seeds: u64) -> Option<f64> {
    let hands =
        (0..seeds).flat_map(|seed| [false, true].map(|backward| Hand { samples, noise, backward, seed }));
    hands.map(|hand| off(shape, hand)).try_fold(0_f64, |worst, off| Some(worst.max(off?)))
}

/// From how many samples on a shape is met within the goal, and how far it may be off from there on, in percent.
struct Goal {
    name: &'static str,
    /// For strokes that are clean, and with noise of 0.5 % and 2 % of the shape's size.
    from: [usize; 3],
    most: [f64; 3],
}

/// The goal is 0.5 % for clean strokes and 1.5 % for shaky ones, from 30 samples on. Where a side goes on past its last
/// sample is only known of straight sides with three samples and of arcs with four (letters, spiral), and in noise of
/// 2 % the places of sharp tips are not.
const GOALS: [Goal; 11] = [
    Goal { name: "circle", from: [30, 30, 120], most: [0.5, 1.5, 1.5] },
    Goal { name: "ellipse", from: [30, 30, 250], most: [0.5, 1.5, 1.5] },
    Goal { name: "rounded square", from: [60, 30, 250], most: [0.5, 1.5, 1.5] },
    Goal { name: "star", from: [30, 60, 500], most: [0.5, 1.5, 1.7] },
    Goal { name: "crescent", from: [30, 120, 500], most: [0.5, 1.5, 2.3] },
    Goal { name: "spiral", from: [500, 1000, 1000], most: [0.5, 1.8, 4.5] },
    Goal { name: "figure of eight", from: [60, 30, 120], most: [0.5, 1.5, 1.5] },
    Goal { name: "A", from: [60, 120, 1000], most: [0.5, 1.5, 1.7] },
    Goal { name: "B", from: [120, 250, 1000], most: [0.5, 1.5, 2.9] },
    Goal { name: "O", from: [30, 30, 1000], most: [0.5, 1.5, 1.5] },
    Goal { name: "R", from: [250, 250, 1000], most: [0.5, 1.5, 1.8] },
];

#[test]
fn curves_are_near_the_shapes_that_were_drawn() {
    let mut wrong = Vec::new();
    for (column, noise) in [0., 0.005, 0.02].into_iter().enumerate() {
        println!("noise {} %; samples {COUNTS:?}", 100. * noise);
        for (shape, goal) in shapes().iter().zip(GOALS) {
            assert_eq!(shape.name, goal.name);
            print!("{:16}", shape.name);
            for samples in COUNTS {
                let off = worst(shape, samples, noise, 2);
                print!("{}", off.map_or("     -".into(), |off| format!("{:6.2}", 100. * off)));
                if samples >= goal.from[column] && off.is_none_or(|off| 100. * off > goal.most[column]) {
                    wrong.push(format!("{} of {samples} samples, noise {noise}: {off:?}", shape.name));
                }
            }
            println!();
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}
