//! Which material a voxel is made of, kept only where it is not the default.

use super::bits::Bits;

/// Voxels in a word.
pub(crate) const WORD_VOXELS: usize = 64;

/// Words along y and z in a page.
const PAGE: usize = 8;

/// The materials of a page: 64 × 8 × 8 voxels.
type Page = [[u8; WORD_VOXELS]; PAGE * PAGE];

/// A material for each voxel; 0 is the default, and costs nothing where nothing else was used.
#[derive(Clone, Debug)]
pub(crate) struct Materials {
    /// Pages along x, y and z.
    pages_along: [usize; 3],
    pages: Vec<Option<Box<Page>>>,
}

impl Materials {
    pub fn new(bits: &Bits) -> Self {
        let pages_along = [bits.words, bits.size[1].div_ceil(PAGE), bits.size[2].div_ceil(PAGE)];
        Self { pages_along, pages: vec![None; pages_along.iter().product()] }
    }

    /// The page of a word, and where in the page it is.
    fn find(&self, [w, y, z]: [usize; 3]) -> (usize, usize) {
        let page = (z / PAGE * self.pages_along[1] + y / PAGE) * self.pages_along[0] + w;
        (page, z % PAGE * PAGE + y % PAGE)
    }

    /// The materials of the 64 voxels of a word.
    pub fn of_word(&self, place: [usize; 3]) -> [u8; WORD_VOXELS] {
        let (page, at) = self.find(place);
        self.pages[page].as_ref().map_or([0; WORD_VOXELS], |page| page[at])
    }

    /// Changes the materials of the 64 voxels of a word.
    pub fn set_word(&mut self, place: [usize; 3], materials: [u8; WORD_VOXELS]) {
        let (page, at) = self.find(place);
        if self.pages[page].is_some() || materials != [0; WORD_VOXELS] {
            self.pages[page].get_or_insert_with(|| Box::new([[0; WORD_VOXELS]; PAGE * PAGE]))[at] = materials;
        }
    }

    /// Bytes that materials take now.
    pub fn bytes(&self) -> usize {
        self.pages.iter().flatten().count() * size_of::<Page>() + self.pages.len() * size_of::<usize>()
    }
}
