//! Where a cache keeps its bricks: a box of pages, each made when first looked at.

use super::bricks::CacheBrick;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Bricks along each side of a page.
const PAGE: i32 = 4;

/// The bricks of a page, x fastest.
type Page = [OnceLock<Arc<Kept>>];

/// How many more bricks may be kept.
#[derive(Debug)]
pub(crate) struct Budget(AtomicUsize);

/// The room of one brick, given back when dropped.
#[derive(Debug)]
struct Room(Arc<Budget>);

impl Budget {
    pub fn new(bricks: usize) -> Self {
        Self(AtomicUsize::new(bricks))
    }

    /// Whether there is no room left.
    pub fn is_spent(&self) -> bool {
        self.0.load(Ordering::Relaxed) == 0
    }

    fn take(self: &Arc<Self>) -> Option<Room> {
        let less = |left: usize| left.checked_sub(1);
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).ok().map(|_| Room(self.clone()))
    }
}

impl Drop for Room {
    fn drop(&mut self) {
        self.0.0.fetch_add(1, Ordering::Relaxed);
    }
}

/// A brick and the room that its samples take.
#[derive(Debug)]
struct Kept {
    brick: CacheBrick,
    _room: Option<Room>,
}

/// A brick that is kept, or made for one question.
#[derive(Debug)]
pub(crate) enum Found<'a> {
    Kept(&'a CacheBrick),
    Made(Box<CacheBrick>),
}

impl Found<'_> {
    #[inline(always)]
    pub fn brick(&self) -> &CacheBrick {
        match self {
            Self::Kept(brick) => brick,
            Self::Made(brick) => brick,
        }
    }
}

/// The bricks of a box, shared with other versions where these cannot differ.
#[derive(Debug)]
pub(crate) struct Pages {
    /// Page of the lowest brick.
    low: [i32; 3],
    sides: [usize; 3],
    pages: Vec<OnceLock<Arc<Page>>>,
    budget: Arc<Budget>,
}

impl Pages {
    /// Room for the bricks with keys from `low` to `high`.
    pub fn new(low: [i32; 3], high: [i32; 3], budget: Arc<Budget>) -> Self {
        let (low, high) = (low.map(page_of), high.map(page_of));
        let sides: [usize; 3] = std::array::from_fn(|a| {
            let side = i64::from(high[a]) - i64::from(low[a]) + 1;
            usize::try_from(side).unwrap_or(0)
        });
        let pages = (0..sides.iter().product()).map(|_| OnceLock::new()).collect();
        Self { low, sides, pages, budget }
    }

    /// The brick with this key, made if it was not; outside the box the field is 0.
    ///
    /// Without room left it is made for this question only. So what is answered never depends on what is kept.
    pub fn brick(&self, key: [i32; 3], make: impl FnOnce() -> CacheBrick) -> Found<'_> {
        let Some(page) = self.index(key.map(page_of)) else { return Found::Kept(&CacheBrick::Empty) };
        let page = self.pages[page].get_or_init(new_page);
        let slot = &page[place_in_page(key)];
        if let Some(known) = slot.get() {
            return Found::Kept(&known.brick);
        }
        let Some(room) = self.budget.take() else {
            return Found::Made(Box::new(make()));
        };
        let kept = slot.get_or_init(|| {
            let brick = make();
            let needs_room = matches!(brick, CacheBrick::Samples { .. });
            Arc::new(Kept { brick, _room: needs_room.then_some(room) })
        });
        Found::Kept(&kept.brick)
    }

    /// Takes over the older bricks that did not change, as `changed` says of those with keys from one to another.
    pub fn inherit(&mut self, older: &Self, changed: impl Fn([i32; 3], [i32; 3]) -> bool) {
        for (number, page) in older.pages.iter().enumerate() {
            let Some(page) = page.get() else { continue };
            let [x, y, _] = older.sides;
            let at = [number % x, number / x % y, number / x / y];
            let at: [i32; 3] = std::array::from_fn(|a| older.low[a] + at[a] as i32);
            let Some(own) = self.index(at) else { continue };
            let first = at.map(|a| a * PAGE);
            let inherited = if changed(first, first.map(|k| k + PAGE - 1)) {
                unchanged_bricks(page, first, &changed)
            } else {
                page.clone()
            };
            self.pages[own] = OnceLock::from(inherited);
        }
    }

    fn index(&self, page: [i32; 3]) -> Option<usize> {
        let mut at = [0; 3];
        for a in 0..3 {
            at[a] = usize::try_from(page[a].checked_sub(self.low[a])?).ok()?;
            if at[a] >= self.sides[a] {
                return None;
            }
        }
        Some(at[0] + self.sides[0] * (at[1] + self.sides[1] * at[2]))
    }
}

fn page_of(brick: i32) -> i32 {
    brick.div_euclid(PAGE)
}

fn place_in_page(key: [i32; 3]) -> usize {
    let [x, y, z] = key.map(|k| k.rem_euclid(PAGE) as usize);
    x + PAGE as usize * (y + PAGE as usize * z)
}

fn new_page() -> Arc<Page> {
    (0..PAGE * PAGE * PAGE).map(|_| OnceLock::new()).collect()
}

/// A page of those bricks of another that did not change; the lowest of them has the key `first`.
fn unchanged_bricks(page: &Page, first: [i32; 3], changed: impl Fn([i32; 3], [i32; 3]) -> bool) -> Arc<Page> {
    let key = |at: i32| [first[0] + at % PAGE, first[1] + at / PAGE % PAGE, first[2] + at / PAGE / PAGE];
    let kept = |(at, brick): (i32, &OnceLock<Arc<Kept>>)| match brick.get() {
        Some(brick) if !changed(key(at), key(at)) => OnceLock::from(brick.clone()),
        _ => OnceLock::new(),
    };
    (0..).zip(page).map(kept).collect()
}
