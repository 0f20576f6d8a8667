//! What rays meet: one sample for each ray, several rays for each pixel.

use glam::{Vec2, Vec3};

/// Rays along each side of a pixel.
pub const RAYS: usize = 2;

/// What kind of thing a ray met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Nothing.
    #[default]
    Nothing,
    /// The ground under the shape.
    Ground,
    /// The shape's surface.
    Surface,
    /// A surface from behind, which only a mesh with holes shows.
    Inside,
}

/// What one ray met.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Towards the viewer in camera space, mm; minus infinity where nothing was met.
    pub depth: f32,
    /// Unit normal in camera space, in 32767ths.
    normal: [i16; 3],
    /// sRGB.
    pub color: [u8; 3],
    /// What it is.
    pub kind: Kind,
}

impl Sample {
    /// A ray that meets nothing.
    pub const NOTHING: Self =
        Self { depth: f32::NEG_INFINITY, normal: [0, 0, i16::MAX], color: [0; 3], kind: Kind::Nothing };

    /// A ray that meets something; a normal of length 0 is taken to face the viewer.
    pub fn new(depth: f32, normal: Vec3, color: [u8; 3], kind: Kind) -> Self {
        let unit = normal.try_normalize().unwrap_or(Vec3::Z);
        let normal = (unit * f32::from(i16::MAX)).to_array().map(|c| c.round() as i16);
        Self { depth, normal, color, kind }
    }

    /// The unit normal in camera space.
    pub fn normal(&self) -> Vec3 {
        Vec3::from_array(self.normal.map(f32::from)).normalize_or(Vec3::Z)
    }
}

/// Where the rays of a picture are: on the lattice of all multiples of `pitch` around the camera's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Rays across.
    pub columns: usize,
    /// Rays down.
    pub rows: usize,
    /// Distance of neighbouring rays, mm.
    pub pitch: f32,
}

impl Frame {
    /// The lattice index of a column, growing to the right.
    pub fn x_index(&self, column: usize) -> i32 {
        column as i32 - self.columns as i32 / 2
    }

    /// The lattice index of a row, growing upwards; row 0 is on top.
    pub fn y_index(&self, row: usize) -> i32 {
        self.rows as i32 / 2 - 1 - row as i32
    }

    /// The point in camera space that a ray has at this depth, mm.
    pub fn point(&self, column: usize, row: usize, depth: f32) -> Vec3 {
        Vec3::new(self.x_index(column) as f32 * self.pitch, self.y_index(row) as f32 * self.pitch, depth)
    }

    /// The column and row at a place in camera space, as numbers with fractions, maybe outside the picture.
    pub fn place_of(&self, p: Vec3) -> [f32; 2] {
        [p.x / self.pitch + (self.columns / 2) as f32, (self.rows / 2) as f32 - 1.0 - p.y / self.pitch]
    }
}

/// The samples of all rays, row by row from the top.
#[derive(Clone, Debug)]
pub struct Buffer {
    /// Where the rays are.
    pub frame: Frame,
    /// `frame.columns · frame.rows` of them.
    pub samples: Vec<Sample>,
}

impl Buffer {
    /// All rays, having met nothing.
    pub fn new(frame: Frame) -> Self {
        Self { frame, samples: vec![Sample::NOTHING; frame.columns * frame.rows] }
    }

    /// The depth of one ray in every `step`, across and down.
    pub fn relief(&self, step: usize) -> Relief {
        let columns = self.frame.columns.div_ceil(step);
        let rows = self.samples.chunks(self.frame.columns).step_by(step);
        let depths = rows.flat_map(|row| row.iter().step_by(step).map(|sample| sample.depth)).collect();
        Relief { columns, rows: self.frame.rows.div_ceil(step), depths }
    }
}

/// Depths alone, small enough to look up all over the place.
#[derive(Clone, Debug)]
pub struct Relief {
    /// How many across.
    pub columns: usize,
    /// How many down.
    pub rows: usize,
    depths: Vec<f32>,
}

impl Relief {
    /// The depth nearest to a place, mm, also for places outside.
    pub fn nearest(&self, at: Vec2) -> (usize, usize, f32) {
        let column = ((at.x + 0.5).max(0.0) as usize).min(self.columns - 1);
        let row = ((at.y + 0.5).max(0.0) as usize).min(self.rows - 1);
        (column, row, self.depths[row * self.columns + column])
    }
}
