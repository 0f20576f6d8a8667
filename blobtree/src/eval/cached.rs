//! Programs run through caches: interpolated where that is accurate, exact at all other places.

use super::places::{Cloud, Places, ROW, Row};
use super::sampler::TreeSampler;
use super::scratch::Slopes;
use super::slopes::Want;

impl TreeSampler<'_> {
    /// Writes the values of the cache of this number, or of its operand `exact`, at every place.
    pub(crate) fn cached_values<P: Places>(
        &mut self,
        number: u32,
        creased: bool,
        exact: usize,
        places: &P,
        out: &mut [[f32; ROW]],
    ) {
        let reader = &mut self.readers[number as usize];
        let missing = each_place(places, |r, i, place| {
            let found = reader.read(place, creased);
            found.map(|slope| out[r][i] = slope.value).is_some()
        });
        let Some(cloud) = self.cloud_at(places, &missing) else { return };
        let mut values = self.scratch.take_values(cloud.rows());
        self.run_values(self.narrower.arena[exact], &cloud, &mut values);
        for (value, at) in values.as_flattened().iter().zip(&missing) {
            out[at / ROW][at % ROW] = *value;
        }
        self.scratch.give_values(values);
        self.scratch.give_cloud(cloud);
    }

    /// The same for values with gradients.
    pub(crate) fn cached_slopes<P: Places>(
        &mut self,
        number: u32,
        creased: bool,
        exact: usize,
        places: &P,
        out: &mut Slopes,
        want: Want,
    ) {
        let reader = &mut self.readers[number as usize];
        let missing = each_place(places, |r, i, place| {
            let found = reader.read(place, creased);
            found.map(|slope| out.set(r, i, slope)).is_some()
        });
        let Some(cloud) = self.cloud_at(places, &missing) else { return };
        let mut slopes = self.scratch.take_slopes(cloud.rows());
        self.run_slopes(self.narrower.arena[exact], &cloud, &mut slopes, want);
        for (from, at) in missing.iter().enumerate() {
            out.set(at / ROW, at % ROW, slopes.get(from / ROW, from % ROW));
        }
        self.scratch.give_slopes(slopes);
        self.scratch.give_cloud(cloud);
    }

    /// The places with these numbers, the last row filled up with the last of them; `None` without any.
    fn cloud_at<P: Places>(&mut self, places: &P, numbers: &[usize]) -> Option<Cloud> {
        let last = *numbers.last()?;
        let rows = numbers.len().div_ceil(ROW);
        let mut cloud = self.scratch.take_cloud(rows);
        for to in 0..rows * ROW {
            let at = *numbers.get(to).unwrap_or(&last);
            cloud.set(to / ROW, to % ROW, places.row(at / ROW).place(at % ROW));
        }
        Some(cloud)
    }
}

/// The numbers of the places for which `is_known` does not know what belongs there.
fn each_place<P: Places>(places: &P, mut is_known: impl FnMut(usize, usize, [f32; 3]) -> bool) -> Vec<usize> {
    let mut missing = Vec::new();
    for r in 0..places.rows() {
        let row = places.row(r);
        for i in 0..ROW {
            if !is_known(r, i, row.place(i)) {
                missing.push(r * ROW + i);
            }
        }
    }
    missing
}
