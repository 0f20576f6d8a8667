//! Smoothing of a sequence of places: least squares against bending.

use glam::DVec2;

/// Minimises Σ wᵢ·|qᵢ − pᵢ|² + ∫ λ·|q″|² over places qᵢ at `times`, with a free bending at the ends.
///
/// - **In:** ascending `times`; `weights` > 0; `bending` is λ at each place, ≥ 0.
/// - **Cost:** linear. **Source:** the discrete natural smoothing spline; the second derivative is the divided
///   difference over neighbours, so the matrix has five diagonals.
pub(super) fn smooth(places: &[DVec2], times: &[f64], weights: &[f64], bending: &[f64]) -> Vec<DVec2> {
    let n = places.len();
    if n < 3 {
        return places.to_vec();
    }
    let mut diagonals: Vec<[f64; 3]> = weights.iter().map(|&w| [w, 0., 0.]).collect();
    for i in 1..n - 1 {
        let (before, after) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        let span = before + after;
        let row = [2. / (before * span), -2. / (before * after), 2. / (after * span)];
        let scale = bending[i] * span / 2.;
        for a in 0..3 {
            for b in a..3 {
                diagonals[i - 1 + a][b - a] += scale * row[a] * row[b];
            }
        }
    }
    let right: Vec<DVec2> = places.iter().zip(weights).map(|(&p, &w)| w * p).collect();
    solve(diagonals, right)
}

/// Solves a symmetric positive definite system with two diagonals beside the main one, by L·D·Lᵀ.
fn solve(mut rows: Vec<[f64; 3]>, mut right: Vec<DVec2>) -> Vec<DVec2> {
    let n = rows.len();
    for i in 0..n {
        let [pivot, near, far] = rows[i];
        let (near_share, far_share) = (near / pivot, far / pivot);
        if i + 1 < n {
            rows[i + 1][0] -= near_share * near;
            rows[i + 1][1] -= near_share * far;
            right[i + 1] = right[i + 1] - near_share * right[i];
        }
        if i + 2 < n {
            rows[i + 2][0] -= far_share * far;
            right[i + 2] = right[i + 2] - far_share * right[i];
        }
        rows[i] = [pivot, near_share, far_share];
    }
    for i in (0..n).rev() {
        right[i] /= rows[i][0];
        if i + 1 < n {
            right[i] = right[i] - rows[i][1] * right[i + 1];
        }
        if i + 2 < n {
            right[i] = right[i] - rows[i][2] * right[i + 2];
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_stays_and_a_bump_goes() {
        let times: Vec<f64> = (0..40).map(|i| f64::from(i) + 0.3 * f64::from(i % 3)).collect();
        let mut places: Vec<DVec2> = times.iter().map(|&t| DVec2::new(t, 2. * t)).collect();
        let weights = vec![1.; 40];
        let kept = smooth(&places, &times, &weights, &[1e4; 40]);
        assert!(kept.iter().zip(&places).all(|(a, b)| a.distance(*b) < 1e-6));
        places[20].y += 1.;
        let calmer = smooth(&places, &times, &weights, &[1e4; 40]);
        assert!((calmer[20].y - 2. * times[20]).abs() < 0.1);
        let as_it_is = smooth(&places, &times, &weights, &[0.; 40]);
        assert!(as_it_is.iter().zip(&places).all(|(a, b)| a.distance(*b) < 1e-9));
    }
}
