//! What a layer may reach beyond the one below: a disc, made of steps to neighbouring voxels.
//!
//! On voxels as wide as layers are high, a disc of radius `h · tan 45°` is one voxel in radius, and no set of voxels
//! that small is round: the paper's 3×3 square lets 54.7° through along the diagonals, a plus only 35.3°. A set of
//! voxels that changes from layer to layer can be round all the same, because reaches add up: after n layers a
//! solid has grown by the Minkowski sum of n sets, and sums of few small polygons come close to any disc.
//!
//! The smallest sets are *steps*: the voxel itself and some opposite pairs of its eight neighbours. Four of them
//! are slanted, like `{(±1, ±1) with equal signs, (±1, 0), (0, 0)}`, whose outline has sides along (2, 1). With the
//! plus (sides along the diagonals), the square (sides along the axes) and standing still, they can sum up to a
//! polygon of 16 sides of the right lengths, which is round to 1 %. [`Element::round`] takes as many of each as
//! Crofton's formula says, spread as evenly as can be.

use crate::voxels::{MAX_VOXELS, VoxelSize};
use crate::{OverhangAngle, SupportRule};

/// A voxel itself, and those of its eight neighbours that a step reaches; always opposite ones together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step(u8);

impl Step {
    /// Neighbours along x: (±1, 0).
    const X: u8 = 1;
    /// Neighbours along y: (0, ±1).
    const Y: u8 = 2;
    /// Neighbours with equal signs: (1, 1) and (−1, −1).
    const RISING: u8 = 4;
    /// Neighbours with opposite signs: (1, −1) and (−1, 1).
    const FALLING: u8 = 8;

    pub const STILL: Self = Self(0);
    pub const SQUARE: Self = Self(Self::X | Self::Y | Self::RISING | Self::FALLING);
    const PLUS: Self = Self(Self::X | Self::Y);
    /// Sides along (2, 1), (1, 2), (1, −2) and (2, −1). Neighbours in this order are as different as can be.
    const SLANTED: [Self; 4] = [
        Self(Self::X | Self::RISING),
        Self(Self::Y | Self::FALLING),
        Self(Self::Y | Self::RISING),
        Self(Self::X | Self::FALLING),
    ];

    /// All ones where the step reaches neighbours along x, along y, with equal, and with opposite signs.
    #[inline(always)]
    pub fn masks(self) -> [u64; 4] {
        [Self::X, Self::Y, Self::RISING, Self::FALLING].map(|pair| if self.0 & pair == 0 { 0 } else { !0 })
    }

    /// Whether it reaches the neighbour at this offset, each −1 to 1.
    pub fn reaches(self, [dx, dy]: [i32; 2]) -> bool {
        let pair = match (dx, dy) {
            (0, 0) => return true,
            (_, 0) => Self::X,
            (0, _) => Self::Y,
            _ if dx == dy => Self::RISING,
            _ => Self::FALLING,
        };
        self.0 & pair != 0
    }
}

/// Most steps that a layer may take: the reach in voxel widths, rounded up.
pub(crate) const MAX_STEPS: usize = 8;

/// How far each layer may reach beyond the one below, in steps from voxel to voxel: B(r) of equation 1.
///
/// **Source:** Reiner & Lefebvre 2016, §2.1 and §3.2. **Departs:** theirs is one 3×3 square for all layers
/// ([`Self::square`]); [`Self::round`] is a disc in effect, for any overhang and voxel width.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    steps: Vec<Step>,
    per_layer: usize,
}

/// Why there is no element.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ElementError {
    /// A layer would take too many steps.
    #[error(
        "a layer reaches {reach_mm} mm, which is {voxels} voxels of {width} mm; \
         take voxels of at least {least} mm"
    )]
    TooFine {
        /// How far a layer may reach beyond the one below, mm.
        reach_mm: f32,
        /// The same in voxel widths.
        voxels: f32,
        /// Width of a voxel, mm.
        width: f32,
        /// The least width that works, mm.
        least: f32,
    },
}

impl Element {
    /// The disc of radius `h · tan θ` on voxels of this size.
    ///
    /// - **Promises:** over many layers, the overhang let through is within 0.6° of θ in every direction, for θ from
    ///   20° to 70° (0.54° is the worst there is). Over few it is as rough as voxels are: after any number of
    ///   layers, whichever layer it starts from, the solid has reached as far as the disc to 2.5 voxels if a
    ///   layer takes one or two steps, and to 3.5 if it takes six. A layer never reaches further than the next whole
    ///   number of voxels, in x and in y.
    /// - **Errors:** [`ElementError::TooFine`] if a layer reaches more than 8 voxels.
    pub fn round(overhang: OverhangAngle, size: VoxelSize) -> Result<Self, ElementError> {
        let reach = size.height() * overhang.radians().tan();
        let voxels = f64::from(reach) / f64::from(size.width());
        let shares = Shares::of_disc();
        // A thousandth of a step less is no worse, and 45° on cubic voxels must not take two steps by rounding.
        let per_layer = ((voxels * shares.total() - 1e-3).ceil() as usize).max(1);
        if per_layer > MAX_STEPS {
            let least = f64::from(reach) * shares.total() / MAX_STEPS as f64;
            let least = (least * 1e4).ceil() as f32 / 1e4;
            let (reach_mm, voxels, width) = (reach, voxels as f32, size.width());
            return Err(ElementError::TooFine { reach_mm, voxels, width, least });
        }
        let shares = shares.scaled(voxels / per_layer as f64);
        Ok(Self { steps: shares.spread(per_layer * MAX_VOXELS), per_layer })
    }

    /// The disc for a rule, on voxels as wide as its layers are high.
    pub fn for_rule(rule: SupportRule) -> Result<Self, ElementError> {
        Self::round(rule.overhang, VoxelSize::cubic(rule.layer_height))
    }

    /// The paper's 3×3 square: 45° along the axes and 54.7° along the diagonals, on cubic voxels.
    pub fn square() -> Self {
        Self { steps: vec![Step::SQUARE; MAX_VOXELS], per_layer: 1 }
    }

    /// Steps that a layer takes: how far it reaches at most, in voxels along x and along y.
    pub fn reach(&self) -> usize {
        self.per_layer
    }

    /// The steps from layer `below` to the next.
    pub(crate) fn steps(&self, below: usize) -> &[Step] {
        &self.steps[below * self.per_layer..][..self.per_layer]
    }

    /// All offsets by which layer `below` carries voxels of the next, row by row. Offsets come with their opposites.
    pub fn offsets(&self, below: usize) -> Vec<[i32; 2]> {
        let reach = self.per_layer as i32;
        let side = 2 * reach + 1;
        let index = |[x, y]: [i32; 2]| ((y + reach) * side + x + reach) as usize;
        let all = || (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
        let mut reached = vec![false; (side * side) as usize];
        reached[index([0, 0])] = true;
        for step in self.steps(below) {
            let before = reached.clone();
            let inside = |[x, y]: [i32; 2]| x.abs() <= reach && y.abs() <= reach;
            for [x, y] in all() {
                let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [dx, dy]));
                let mut from = around.filter(|&d| step.reaches(d)).map(|[dx, dy]| [x + dx, y + dy]);
                reached[index([x, y])] = from.any(|at| inside(at) && before[index(at)]);
            }
        }
        all().filter(|&offset| reached[index(offset)]).collect()
    }

    /// The places of layer `below` that carry a place of the next, in a grid of this size along x and y. That is all
    /// at the [`Self::offsets`], but beside the sides of the grid: each single step stays within the grid.
    pub fn carriers(&self, below: usize, place: [usize; 2], grid: [usize; 2]) -> Vec<[usize; 2]> {
        let mut places = vec![place];
        for step in self.steps(below).iter().rev() {
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [dx, dy]));
            let reached = around.filter(|&offset| step.reaches(offset));
            let mut next: Vec<_> = reached
                .flat_map(|offset| places.iter().filter_map(move |&from| shifted(from, offset, grid)))
                .collect();
            next.sort_unstable();
            next.dedup();
            places = next;
        }
        places
    }
}

/// A place of a layer moved by an offset, if that is still in the layer.
pub(super) fn shifted([x, y]: [usize; 2], [dx, dy]: [i32; 2], [nx, ny]: [usize; 2]) -> Option<[usize; 2]> {
    let (x, y) = (x.checked_add_signed(dx as isize)?, y.checked_add_signed(dy as isize)?);
    (x < nx && y < ny).then_some([x, y])
}

/// How often each step is taken, per step.
#[derive(Clone, Copy, Debug)]
struct Shares {
    slanted: f64,
    plus: f64,
    square: f64,
}

impl Shares {
    /// Those that sum up to a disc of one voxel in radius.
    ///
    /// A polygon with sides in the directions d, each of length 2·s(d) and there twice, comes closest to a disc if
    /// s(d) is half the angle of all directions nearest to d (Crofton). A slanted step has the sides (2, 1) and
    /// (0, 1), halved and both ways; a plus (1, 1) and (1, −1); a square (1, 0) and (0, 1), not halved.
    fn of_disc() -> Self {
        let slant = 0.5f64.atan();
        let diagonal = std::f64::consts::FRAC_PI_4;
        let axis_side = slant / 2.0;
        let slanted_side = diagonal / 4.0;
        let diagonal_side = (diagonal - slant) / 2.0;
        let slanted = slanted_side / (0.5 * 5.0f64.sqrt());
        // Two slanted steps have the side (0, 1), half as long as the square's.
        Self { slanted, plus: diagonal_side / 0.5f64.sqrt(), square: axis_side - slanted }
    }

    /// Steps for a radius of one voxel.
    fn total(self) -> f64 {
        4.0 * self.slanted + self.plus + self.square
    }

    fn scaled(self, by: f64) -> Self {
        Self { slanted: self.slanted * by, plus: self.plus * by, square: self.square * by }
    }

    /// That many steps, each kind as evenly as can be: every kind gains its share at every step, and the one that
    /// has gained most is taken and pays one.
    fn spread(self, steps: usize) -> Vec<Step> {
        let [a, b, c, d] = Step::SLANTED.map(|step| (step, self.slanted));
        let still = (1.0 - self.total()).max(0.0);
        let kinds = [a, b, c, d, (Step::PLUS, self.plus), (Step::SQUARE, self.square), (Step::STILL, still)];
        let mut gained = [0.0f64; 7];
        let next = |_| {
            let mut best = 0;
            for (kind, (_, share)) in kinds.iter().enumerate() {
                gained[kind] += share;
                if gained[kind] > gained[best] {
                    best = kind;
                }
            }
            gained[best] -= 1.0;
            kinds[best].0
        };
        (0..steps).map(next).collect()
    }
}
