//! Warps compiled for evaluation: the way back from the deformed space into the child's.

use crate::field::Aabb;
use crate::leaf::Frame;
use crate::scalar::{Scalar, Slope, Triple, both_pieces};
use crate::warp::{Axis, Bend, Taper, Twist};
use glam::{DAffine3, Vec3};

/// A deformation that cannot be folded into the leaves below it.
#[derive(Clone, Debug)]
pub(crate) enum WarpMap {
    /// An affine map above another deformation.
    Affine(AffineWarp),
    Taper(TaperMap),
    Twist(TwistMap),
    Bend(BendMap),
}

/// A place in the child's space, and the derivatives of its coordinates (rows) by those of the place in the
/// parent's (columns).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Warped<S> {
    pub place: Triple<S>,
    pub rows: [[S; 3]; 3],
    /// Tells apart stretches between which the derivatives jump.
    pub piece: u32,
}

impl<S: Scalar> Warped<S> {
    /// The piece of a field above the warp; where the field is 0, the warp's jumps are not felt.
    pub fn piece_of(&self, inner: &Slope<S>) -> u32 {
        if inner.value.value() > 0.0 { both_pieces(inner.piece, self.piece) } else { inner.piece }
    }

    /// A gradient in the child's space, as one in the parent's.
    #[inline(always)]
    pub fn pull_back(&self, g: Triple<S>) -> Triple<S> {
        std::array::from_fn(|c| self.rows[0][c] * g[0] + self.rows[1][c] * g[1] + self.rows[2][c] * g[2])
    }
}

impl WarpMap {
    /// Where the point `p` of the deformed space comes from.
    #[inline(always)]
    pub fn child_from_parent<S: Scalar>(&self, p: Triple<S>) -> Warped<S> {
        match self {
            Self::Affine(w) => {
                Warped { place: w.child_from_parent.apply(p), rows: w.child_from_parent.rows(), piece: 0 }
            }
            Self::Taper(w) => w.child_from_parent(p),
            Self::Twist(w) => w.child_from_parent(p),
            Self::Bend(w) => w.child_from_parent(p),
        }
    }

    /// A box in the child's space around where all points of `region` come from.
    pub fn child_region(&self, region: &Aabb) -> Aabb {
        let region = match self {
            Self::Affine(w) => w.child_from_parent.range(region).to_box(),
            Self::Taper(w) => w.child_region(region),
            Self::Twist(w) => w.child_region(region),
            Self::Bend(w) => w.child_region(region),
        };
        with_room(region)
    }

    /// A box in the parent's space around where all points of the child's `region` go.
    pub fn parent_region(&self, region: &Aabb) -> Aabb {
        if region.is_empty() {
            return *region;
        }
        let region = match self {
            Self::Affine(w) => {
                let map = |p: Vec3| w.parent_from_child.transform_point3(p.as_dvec3()).as_vec3();
                Aabb::of_points(region.corners().map(map))
            }
            Self::Taper(w) => w.parent_region(region),
            Self::Twist(w) => w.parent_region(region),
            Self::Bend(w) => w.parent_region(region),
        };
        with_room(region)
    }

    /// Whether the derivatives of the map may jump in `region`, of the deformed space.
    pub fn creased(&self, region: &Aabb) -> bool {
        match self {
            Self::Taper(w) => {
                let (lo, hi) = along(region, w.axes[0]);
                [w.start, w.end].iter().any(|end| lo <= *end && *end <= hi)
            }
            Self::Affine(_) | Self::Twist(_) => false,
            Self::Bend(w) => w.creased(region),
        }
    }
}

/// Room for rounding errors.
fn with_room(region: Aabb) -> Aabb {
    region.grown(2e-6 * region.min.abs().max(region.max.abs()).max_element())
}

fn along(region: &Aabb, axis: usize) -> (f32, f32) {
    (region.min[axis], region.max[axis])
}

fn set(region: &mut Aabb, axis: usize, (lo, hi): (f32, f32)) {
    region.min[axis] = lo;
    region.max[axis] = hi;
}

fn identity<S: Scalar>() -> [[S; 3]; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| S::of(if r == c { 1.0 } else { 0.0 })))
}

/// An affine map and its inverse.
#[derive(Clone, Debug)]
pub(crate) struct AffineWarp {
    child_from_parent: Frame,
    parent_from_child: DAffine3,
}

impl AffineWarp {
    pub fn new(child_from_parent: &DAffine3) -> Self {
        Self {
            child_from_parent: Frame::new(*child_from_parent),
            parent_from_child: child_from_parent.inverse(),
        }
    }
}

/// [`Taper`], compiled.
#[derive(Clone, Debug)]
pub(crate) struct TaperMap {
    axes: [usize; 3],
    start: f32,
    end: f32,
    scale: f32,
}

impl TaperMap {
    pub fn new(taper: &Taper) -> Self {
        Self { axes: taper.axis.indices(), start: taper.start, end: taper.end, scale: taper.scale }
    }

    /// The scale of the cross-section at `w`, and its derivative.
    #[inline(always)]
    fn scale_at<S: Scalar>(&self, w: S) -> (S, S) {
        let growth = (self.scale - 1.0) / (self.end - self.start);
        let inside = w.larger(S::of(self.start)).smaller(S::of(self.end));
        let moving = self.start < w.value() && w.value() < self.end;
        let slope = S::of(if moving { growth } else { 0.0 });
        (S::of(1.0) + (inside - S::of(self.start)) * S::of(growth), slope)
    }

    fn child_from_parent<S: Scalar>(&self, p: Triple<S>) -> Warped<S> {
        let [w, u, v] = self.axes;
        let (scale, slope) = self.scale_at(p[w]);
        let inverse = S::of(1.0) / scale;
        let (mut place, mut rows) = (p, identity());
        for a in [u, v] {
            place[a] = p[a] * inverse;
            rows[a][a] = inverse;
            rows[a][w] = -(place[a] * slope * inverse);
        }
        let at = p[w].value();
        let piece = if at <= self.start {
            0
        } else if at < self.end {
            1
        } else {
            2
        };
        Warped { place, rows, piece }
    }

    fn scaled_section(&self, region: &Aabb, factors: (f32, f32)) -> Aabb {
        let mut section = *region;
        for a in &self.axes[1..] {
            let (lo, hi) = along(region, *a);
            let ends = [lo * factors.0, lo * factors.1, hi * factors.0, hi * factors.1];
            let bounds = ends.iter().fold((f32::MAX, f32::MIN), |b, x| (b.0.min(*x), b.1.max(*x)));
            set(&mut section, *a, bounds);
        }
        section
    }

    fn child_region(&self, region: &Aabb) -> Aabb {
        let (lo, hi) = along(region, self.axes[0]);
        self.scaled_section(region, (1.0 / self.scale_at(lo).0, 1.0 / self.scale_at(hi).0))
    }

    fn parent_region(&self, region: &Aabb) -> Aabb {
        let (lo, hi) = along(region, self.axes[0]);
        self.scaled_section(region, (self.scale_at(lo).0, self.scale_at(hi).0))
    }
}

/// [`Twist`], compiled.
#[derive(Clone, Debug)]
pub(crate) struct TwistMap {
    axes: [usize; 3],
    /// Radians per mm.
    rate: f32,
}

impl TwistMap {
    pub fn new(twist: &Twist) -> Self {
        Self { axes: twist.axis.indices(), rate: twist.degrees_per_mm.to_radians() }
    }

    fn child_from_parent<S: Scalar>(&self, p: Triple<S>) -> Warped<S> {
        let [w, u, v] = self.axes;
        let rate = S::of(self.rate);
        let (sin, cos) = (p[w] * rate).sin_cos();
        let (mut place, mut rows) = (p, identity());
        place[u] = cos * p[u] + sin * p[v];
        place[v] = cos * p[v] - sin * p[u];
        (rows[u][u], rows[u][v], rows[u][w]) = (cos, sin, rate * place[v]);
        (rows[v][u], rows[v][v], rows[v][w]) = (-sin, cos, -(rate * place[u]));
        Warped { place, rows, piece: 0 }
    }

    fn child_region(&self, region: &Aabb) -> Aabb {
        let [w, u, v] = self.axes;
        let (center, half) = (region.center(), region.size() * 0.5);
        let farthest = (center[u].abs() + half[u]).hypot(center[v].abs() + half[v]);
        let (sin, cos) = (center[w] * self.rate).sin_cos();
        let turned = farthest * (half[w] * self.rate).abs();
        let mut child = *region;
        for (axis, middle, reach) in [
            (u, cos * center[u] + sin * center[v], cos.abs() * half[u] + sin.abs() * half[v]),
            (v, cos * center[v] - sin * center[u], cos.abs() * half[v] + sin.abs() * half[u]),
        ] {
            let reach = reach + turned + 1e-6 * farthest;
            set(&mut child, axis, ((middle - reach).max(-farthest), (middle + reach).min(farthest)));
        }
        child
    }

    fn parent_region(&self, region: &Aabb) -> Aabb {
        let [_, u, v] = self.axes;
        let farthest = region.min.abs().max(region.max.abs());
        let farthest = farthest[u].hypot(farthest[v]);
        let mut parent = *region;
        set(&mut parent, u, (-farthest, farthest));
        set(&mut parent, v, (-farthest, farthest));
        parent
    }
}

/// [`Bend`], compiled. Seen in the plane of the arc, `w` runs along the axis and `u` towards the arc's
/// centre, which lies at `w = start`, `u = radius`; angles are measured there.
#[derive(Clone, Debug)]
pub(crate) struct BendMap {
    w: usize,
    u: usize,
    /// −1 if the bend goes away from the positive side of the axis `u`.
    side: f32,
    start: f32,
    end: f32,
    angle: f32,
    radius: f32,
}

/// Which stretch of the axis a point belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stretch {
    Before,
    Arc,
    After,
}

impl BendMap {
    pub fn new(bend: &Bend) -> Self {
        let index = |axis: Axis| axis.indices()[0];
        let angle = bend.degrees.to_radians();
        Self {
            w: index(bend.axis),
            u: index(bend.towards),
            side: angle.signum(),
            start: bend.start,
            end: bend.end,
            angle: angle.abs(),
            radius: (bend.end - bend.start) / angle.abs(),
        }
    }

    /// The angle of a point seen from the arc's centre, its cut opposite to the middle of the arc.
    fn angle_of(&self, along: f32, out: f32) -> f32 {
        let angle = along.atan2(out);
        if angle <= 0.5 * self.angle - std::f32::consts::PI { angle + std::f32::consts::TAU } else { angle }
    }

    fn stretch(&self, along: f32, out: f32) -> Stretch {
        match self.angle_of(along, out) {
            angle if angle < 0.0 => Stretch::Before,
            angle if angle > self.angle => Stretch::After,
            _ => Stretch::Arc,
        }
    }

    fn child_from_parent<S: Scalar>(&self, p: Triple<S>) -> Warped<S> {
        let (w, u, side, radius) = (self.w, self.u, S::of(self.side), S::of(self.radius));
        // From the centre: along the axis, and out from it.
        let (along, out) = (p[w] - S::of(self.start), radius - side * p[u]);
        let (mut place, mut rows) = (p, identity());
        let stretch = self.stretch(along.value(), out.value());
        match stretch {
            Stretch::Before => {}
            Stretch::Arc => {
                let rho2 = (along * along + out * out).larger(S::of(1e-20));
                let rho = rho2.sqrt();
                let turn =
                    S::of(self.angle_of(along.value(), out.value()) - along.value().atan2(out.value()));
                place[w] = S::of(self.start) + radius * (along.atan2(out) + turn);
                place[u] = side * (radius - rho);
                (rows[w][w], rows[w][u]) = (radius * out / rho2, side * radius * along / rho2);
                (rows[u][w], rows[u][u]) = (-(side * along / rho), out / rho);
            }
            Stretch::After => {
                let (sin, cos) = self.angle.sin_cos();
                let (sin, cos) = (S::of(sin), S::of(cos));
                place[w] = S::of(self.end) + (along * cos - out * sin);
                place[u] = side * (radius - (along * sin + out * cos));
                (rows[w][w], rows[w][u]) = (cos, side * sin);
                (rows[u][w], rows[u][u]) = (-(side * sin), cos);
            }
        }
        Warped { place, rows, piece: stretch as u32 }
    }

    /// The region in (along, out) from the centre: two ranges.
    fn seen_from_center(&self, region: &Aabb) -> [(f32, f32); 2] {
        let (lo, hi) = along(region, self.w);
        let (a, b) = along(region, self.u);
        let out = [self.radius - self.side * a, self.radius - self.side * b];
        [(lo - self.start, hi - self.start), (out[0].min(out[1]), out[0].max(out[1]))]
    }

    /// Bounds of the angles and of the distances from the centre.
    fn polar(&self, [along, out]: [(f32, f32); 2]) -> ((f32, f32), (f32, f32)) {
        let nearest = |(lo, hi): (f32, f32)| lo.max(-hi).max(0.0);
        let farthest = |(lo, hi): (f32, f32)| lo.abs().max(hi.abs());
        let rho = (nearest(along).hypot(nearest(out)), farthest(along).hypot(farthest(out)));
        let corners = [(along.0, out.0), (along.0, out.1), (along.1, out.0), (along.1, out.1)];
        let angles = corners.map(|(a, o)| self.angle_of(a, o));
        let bounds = angles.iter().fold((f32::MAX, f32::MIN), |b, x| (b.0.min(*x), b.1.max(*x)));
        // Around the centre, or across the cut, angles are everything.
        let everything = bounds.1 - bounds.0 >= std::f32::consts::PI || rho.0 <= 0.0;
        (if everything { (-std::f32::consts::TAU, std::f32::consts::TAU) } else { bounds }, rho)
    }

    fn creased(&self, region: &Aabb) -> bool {
        let ((lo, hi), _) = self.polar(self.seen_from_center(region));
        [0.0, self.angle].iter().any(|end| lo - 1e-5 <= *end && *end <= hi + 1e-5)
    }

    fn child_region(&self, region: &Aabb) -> Aabb {
        let seen = self.seen_from_center(region);
        let ((lo, hi), rho) = self.polar(seen);
        let slack = 1e-5;
        let mut child = if lo < slack { *region } else { Aabb::EMPTY };
        if hi > self.angle - slack {
            child = child.union(&self.box_of_corners(region, |p| self.unturned(p)));
        }
        if hi > -slack && lo < self.angle + slack {
            let (from, to) = ((lo - slack).max(0.0), (hi + slack).min(self.angle));
            let (nearest, farthest) = (self.radius - rho.1, self.radius - rho.0);
            let mut arc = *region;
            set(&mut arc, self.w, (self.start + self.radius * from, self.start + self.radius * to));
            let across = (self.side * nearest, self.side * farthest);
            set(&mut arc, self.u, (across.0.min(across.1), across.0.max(across.1)));
            child = child.union(&arc);
        }
        child
    }

    /// The box around the images of a box's corners under an affine map.
    fn box_of_corners(&self, region: &Aabb, map: impl Fn(Vec3) -> Vec3) -> Aabb {
        Aabb::of_points(region.corners().map(map))
    }

    /// The stretch after the arc, turned back.
    fn unturned(&self, p: Vec3) -> Vec3 {
        let (sin, cos) = self.angle.sin_cos();
        let (along, out) = (p[self.w] - self.start, self.radius - self.side * p[self.u]);
        let mut q = p;
        q[self.w] = self.end + (along * cos - out * sin);
        q[self.u] = self.side * (self.radius - (along * sin + out * cos));
        q
    }

    /// The stretch after the arc, turned to its place.
    fn turned(&self, q: Vec3) -> Vec3 {
        let (sin, cos) = self.angle.sin_cos();
        let (along, out) = (q[self.w] - self.end, self.radius - self.side * q[self.u]);
        let mut p = q;
        p[self.w] = self.start + (along * cos + out * sin);
        p[self.u] = self.side * (self.radius - (out * cos - along * sin));
        p
    }

    fn parent_region(&self, region: &Aabb) -> Aabb {
        let (lo, hi) = along(region, self.w);
        let mut parent = if lo <= self.start { *region } else { Aabb::EMPTY };
        if hi >= self.end {
            parent = parent.union(&self.box_of_corners(region, |q| self.turned(q)));
        }
        if hi >= self.start && lo <= self.end {
            let [_, out] = self.seen_from_center(region);
            let farthest = out.0.abs().max(out.1.abs());
            let mut arc = *region;
            set(&mut arc, self.w, (self.start - farthest, self.start + farthest));
            let center = self.side * self.radius;
            set(&mut arc, self.u, (center - farthest, center + farthest));
            parent = parent.union(&arc);
        }
        parent
    }
}
