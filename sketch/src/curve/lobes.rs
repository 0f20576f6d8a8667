//! The two lobes of a line that crosses itself once, such as a figure of eight.

use super::Contour;
use super::polygon;
use glam::DVec2;

/// How far the lobes' tips are drawn back from where the line crosses itself, in extents: contours may not touch.
const APART: f64 = 0.0015;
/// The smaller lobe has at least this share of the larger one's area; less is a loop that slipped in.
const LEAST_SHARE: f64 = 0.05;

/// The lobes on both sides of the crossing, each with a corner there.
///
/// None if the line does not cross itself exactly once, and where one loop lies inside the other: that is a curl, and
/// what it encloses is one piece.
pub(super) fn lobes(contour: &Contour) -> Option<[Contour; 2]> {
    let (i, j, at) = polygon::only_crossing(&contour.points)?;
    let n = contour.points.len();
    let apart = APART * polygon::extent(&contour.points);
    let [one, other] = [(i + 1, j - i), (j + 1, n - (j - i))]
        .map(|(from, count)| lobe(contour, (from..from + count).map(|k| k % n), at, apart));
    let lobes = [one?, other?];
    let [a, b] = [0, 1].map(|k| polygon::area(&lobes[k].points));
    let side_by_side = a * b < 0. && a.abs().min(b.abs()) > LEAST_SHARE * a.abs().max(b.abs());
    let sound = !polygon::cross(lobes.iter().map(|lobe| &lobe.points[..]));
    (side_by_side && sound).then_some(lobes)
}

/// The contour through some of the points, closed by a corner a little inside of where they came from.
fn lobe(
    contour: &Contour,
    of: impl DoubleEndedIterator<Item = usize> + Clone,
    at: DVec2,
    apart: f64,
) -> Option<Contour> {
    let far = |&k: &usize| contour.points[k].distance(at) > 2. * apart;
    let (first, last) = (of.clone().find(far)?, of.clone().rfind(far)?);
    let [on, back] = [first, last].map(|k| (contour.points[k] - at).normalize_or_zero());
    let tip = at + apart * (on + back).try_normalize()?;
    let mut lobe = Contour { points: vec![tip], corners: vec![0] };
    for k in of.skip_while(|k| *k != first) {
        if contour.corners.binary_search(&k).is_ok() {
            lobe.corners.push(lobe.points.len());
        }
        lobe.points.push(contour.points[k]);
        if k == last {
            break;
        }
    }
    (lobe.points.len() > 3).then_some(lobe)
}
