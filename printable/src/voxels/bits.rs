//! Bits in layers of rows of words, kept only between the first and the last row of a layer that matter.

use std::ops::Range;

/// The words of a row of voxels: voxel x is bit `x % 64` of word `x / 64`.
pub(crate) type Row<const W: usize> = [u64; W];

/// Runs an expression with the constant `W` set to a volume's words in a row: 1, 2, 4 or 8.
macro_rules! for_width {
    ($words:expr, $W:ident => $body:expr) => {
        match $words {
            1 => {
                const $W: usize = 1;
                $body
            }
            2 => {
                const $W: usize = 2;
                $body
            }
            4 => {
                const $W: usize = 4;
                $body
            }
            _ => {
                const $W: usize = 8;
                $body
            }
        }
    };
}
pub(crate) use for_width;

/// Some rows of a layer; all others are empty.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<'a, const W: usize> {
    /// Number of the first row.
    pub first: usize,
    pub rows: &'a [Row<W>],
}

impl<const W: usize> Rows<'_, W> {
    pub const EMPTY: Self = Self { first: 0, rows: &[] };

    /// The row `y`; empty if it is not kept.
    #[inline(always)]
    pub fn at(&self, y: usize) -> Row<W> {
        self.rows.get(y.wrapping_sub(self.first)).copied().unwrap_or([0; W])
    }

    /// Which rows are kept.
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.rows.len()
    }
}

/// Rows in hand, in memory that is used again and again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block<const W: usize> {
    pub first: usize,
    pub rows: Vec<Row<W>>,
}

impl<const W: usize> Block<W> {
    /// Starts over with these rows, all empty.
    pub fn reset(&mut self, range: Range<usize>) {
        self.first = range.start;
        self.rows.clear();
        self.rows.resize(range.len(), [0; W]);
    }

    pub fn as_rows(&self) -> Rows<'_, W> {
        Rows { first: self.first, rows: &self.rows }
    }

    pub fn range(&self) -> Range<usize> {
        self.as_rows().range()
    }

    /// The row `y`, which must be kept.
    #[inline(always)]
    pub fn at_mut(&mut self, y: usize) -> &mut Row<W> {
        &mut self.rows[y - self.first]
    }

    /// Forgets empty rows at both ends.
    pub fn tighten(&mut self) {
        let full = |row: &Row<W>| row.iter().any(|&word| word != 0);
        let end = self.rows.iter().rposition(full).map_or(0, |last| last + 1);
        self.rows.truncate(end);
        let skipped = self.rows.iter().position(full).unwrap_or(0);
        self.rows.drain(..skipped);
        self.first += skipped;
    }
}

/// One layer of a volume.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layer {
    /// Number of the first row kept.
    first: usize,
    /// The rows from there on.
    words: Vec<u64>,
}

impl Layer {
    /// The rows that are kept. `W` must be the volume's.
    pub fn rows<const W: usize>(&self) -> Rows<'_, W> {
        Rows { first: self.first, rows: self.words.as_chunks().0 }
    }

    /// The rows that are kept, to change, and the number of the first.
    pub fn rows_mut<const W: usize>(&mut self) -> (usize, &mut [Row<W>]) {
        (self.first, self.words.as_chunks_mut().0)
    }

    /// Keeps at least these rows from now on.
    pub fn keep<const W: usize>(&mut self, wanted: Range<usize>) {
        let kept = self.rows::<W>().range();
        if wanted.is_empty() || (!kept.is_empty() && kept.start <= wanted.start && wanted.end <= kept.end) {
            return;
        }
        let all = join(kept.clone(), wanted);
        let mut words = vec![0; all.len() * W];
        let at = kept.start.saturating_sub(all.start) * W;
        words[at..at + self.words.len()].copy_from_slice(&self.words);
        *self = Self { first: all.start, words };
    }

    /// Takes the content of a block.
    pub fn set<const W: usize>(&mut self, block: &Block<W>) {
        self.first = block.first;
        self.words.clear();
        self.words.extend_from_slice(block.rows.as_flattened());
    }
}

/// The smallest range around both; an empty one does not count.
pub(crate) fn join(a: Range<usize>, b: Range<usize>) -> Range<usize> {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b,
        (_, true) => a,
        _ => a.start.min(b.start)..a.end.max(b.end),
    }
}

/// A volume of bits.
#[derive(Clone, Debug)]
pub(crate) struct Bits {
    /// Voxels along x, y and z.
    pub size: [usize; 3],
    /// Words in a row: 1, 2, 4 or 8.
    pub words: usize,
    pub layers: Vec<Layer>,
}

impl Bits {
    /// All empty. At most 512 along x.
    pub fn new(size: [usize; 3]) -> Self {
        let words = size[0].div_ceil(64).next_power_of_two();
        Self { size, words, layers: vec![Layer::default(); size[2]] }
    }

    fn holds(&self, voxel: [usize; 3]) -> bool {
        (0..3).all(|axis| voxel[axis] < self.size[axis])
    }

    pub fn get(&self, voxel: [usize; 3]) -> bool {
        let [x, y, z] = voxel;
        self.holds(voxel) && self.word([x / 64, y, z]) >> (x % 64) & 1 == 1
    }

    /// Changes a bit inside the volume.
    pub fn set(&mut self, [x, y, z]: [usize; 3], full: bool) {
        debug_assert!(self.holds([x, y, z]));
        if full || self.word([x / 64, y, z]) != 0 {
            let word = self.word_mut([x / 64, y, z]);
            *word = *word & !(1 << (x % 64)) | u64::from(full) << (x % 64);
        }
    }

    /// Word number w of row y in layer z; 0 if not kept.
    pub fn word(&self, [w, y, z]: [usize; 3]) -> u64 {
        let layer = &self.layers[z];
        let at = y.wrapping_sub(layer.first).wrapping_mul(self.words).wrapping_add(w);
        if y < layer.first { 0 } else { layer.words.get(at).copied().unwrap_or(0) }
    }

    /// The same, to change.
    pub fn word_mut(&mut self, [w, y, z]: [usize; 3]) -> &mut u64 {
        let words = self.words;
        let layer = &mut self.layers[z];
        for_width!(words, W => layer.keep::<W>(y..y + 1));
        &mut layer.words[(y - layer.first) * words + w]
    }

    /// The number of a word in the whole volume.
    pub fn word_number(&self, [w, y, z]: [usize; 3]) -> u32 {
        ((z * self.size[1] + y) * self.words + w) as u32
    }

    /// The place of a word, from its number.
    pub fn word_place(&self, number: u32) -> [usize; 3] {
        let (row, w) = (number as usize / self.words, number as usize % self.words);
        [w, row % self.size[1], row / self.size[1]]
    }

    /// The words of a full row.
    pub fn full_row<const W: usize>(&self) -> Row<W> {
        run_of_bits(0, self.size[0])
    }

    pub fn count(&self) -> usize {
        self.layers.iter().flat_map(|layer| &layer.words).map(|word| word.count_ones() as usize).sum()
    }

    /// All set bits, x fastest.
    pub fn iter(&self) -> impl Iterator<Item = [usize; 3]> {
        (0..self.size[2]).flat_map(|z| self.iter_layer(z).map(move |[x, y]| [x, y, z]))
    }

    /// All set bits of a layer, x fastest.
    pub fn iter_layer(&self, z: usize) -> impl Iterator<Item = [usize; 2]> {
        let layer = &self.layers[z];
        layer.words.iter().enumerate().flat_map(move |(at, &word)| {
            let (y, w) = (layer.first + at / self.words, at % self.words);
            ones(word).map(move |x| [w * 64 + x, y])
        })
    }
}

/// Equal when the same bits are set, whatever rows are kept.
impl PartialEq for Bits {
    fn eq(&self, other: &Self) -> bool {
        let same_layer = |z: usize| {
            let rows = join(self.kept(z), other.kept(z));
            rows.flat_map(|y| (0..self.words).map(move |w| [w, y, z]))
                .all(|at| self.word(at) == other.word(at))
        };
        self.size == other.size && (0..self.size[2]).all(same_layer)
    }
}

impl Bits {
    /// Which rows of a layer are kept.
    pub fn kept(&self, z: usize) -> Range<usize> {
        let layer = &self.layers[z];
        layer.first..layer.first + layer.words.len() / self.words
    }
}

/// A row moved along x by `by` voxels; what leaves it is lost.
pub(crate) fn moved_row<const W: usize>(row: Row<W>, by: i32) -> Row<W> {
    let (words, bits) = (by.div_euclid(64) as isize, by.rem_euclid(64));
    let word = |w: Option<usize>| w.and_then(|w| row.get(w)).copied().unwrap_or(0);
    std::array::from_fn(|w| {
        let from = w.checked_add_signed(-words);
        let low = word(from.and_then(|w| w.checked_sub(1)));
        // From word −1 on downwards nothing comes; one word further may still spill over.
        let low = if from.is_none() { word(w.checked_add_signed(-words - 1)) } else { low };
        if bits == 0 { word(from) } else { word(from) << bits | low >> (64 - bits) }
    })
}

/// Numbers of the bits set in a word, ascending.
pub(crate) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as usize);
        word &= word.wrapping_sub(1);
        bit
    })
}

/// A row in which bits `from` to `to` (exclusive) are set.
pub(crate) fn run_of_bits<const W: usize>(from: usize, to: usize) -> Row<W> {
    std::array::from_fn(|w| {
        let below = |x: usize| match x.saturating_sub(w * 64) {
            n @ 0..64 => (1u64 << n) - 1,
            _ => !0,
        };
        below(to) & !below(from)
    })
}
