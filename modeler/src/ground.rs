//! The ground below the model: a grid in centimetres, and the printer's room.

use crate::settings::Settings;
use crate::stage::Line;
use glam::Vec3;

/// The distance of grid lines, mm.
const STEP: f32 = 10.0;

/// The lines of the ground, for a light or a dark background.
pub fn lines(settings: &Settings, dark: bool) -> Vec<Line> {
    if !settings.shows_ground {
        return Vec::new();
    }
    let tone = if dark { 255 } else { 40 };
    let line =
        |from: [f32; 3], to: [f32; 3], color| Line { ends: [from.into(), to.into()], color, width: 1.0 };
    let gray = |share: u8| [tone, tone, tone, share];
    let [width, depth, height] = settings.room;
    let (x, y) = (0.5 * width, 0.5 * depth);
    let mut lines = Vec::new();
    let steps = |half: f32| {
        let count = (half / STEP).floor() as i32;
        (-count..=count).map(|i| i as f32 * STEP)
    };
    // Every tenth centimetre stands out; the axes have their colours.
    let share = |at: f32| if (at / (10.0 * STEP)).fract() == 0.0 { 70 } else { 28 };
    lines.extend(steps(x).filter(|at| *at != 0.0).map(|at| line([at, -y, 0.], [at, y, 0.], gray(share(at)))));
    lines.extend(steps(y).filter(|at| *at != 0.0).map(|at| line([-x, at, 0.], [x, at, 0.], gray(share(at)))));
    lines.push(line([-x, 0., 0.], [x, 0., 0.], [200, 60, 60, 150]));
    lines.push(line([0., -y, 0.], [0., y, 0.], [60, 150, 60, 150]));
    let corners = [Vec3::new(-x, -y, 0.), Vec3::new(x, -y, 0.), Vec3::new(x, y, 0.), Vec3::new(-x, y, 0.)];
    let up = Vec3::Z * height;
    for (i, &corner) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        lines.push(Line { ends: [corner, next], color: gray(110), width: 1.0 });
        lines.push(Line { ends: [corner, corner + up], color: gray(22), width: 1.0 });
        lines.push(Line { ends: [corner + up, next + up], color: gray(22), width: 1.0 });
    }
    lines
}
