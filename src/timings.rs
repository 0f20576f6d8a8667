//! Where the time went.

use serde_json::{Map, Value, json};
use std::time::{Duration, Instant};

/// How long every stage took, in each round of the work.
#[derive(Debug, Default)]
pub struct Timings {
    /// In the order of first appearance.
    stages: Vec<(&'static str, Vec<Duration>)>,
    totals: Vec<Duration>,
}

impl Timings {
    /// Does the whole work once and notes how long it took.
    pub fn round<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = Instant::now();
        let result = work(self);
        self.totals.push(start.elapsed());
        result
    }

    /// Notes how long a stage took in this round; several stretches of one stage count together.
    pub fn note(&mut self, stage: &'static str, took: Duration) {
        let round = self.totals.len();
        let index = self.stages.iter().position(|(name, _)| *name == stage).unwrap_or_else(|| {
            self.stages.push((stage, Vec::new()));
            self.stages.len() - 1
        });
        let times = &mut self.stages[index].1;
        times.resize(round + 1, Duration::ZERO);
        times[round] += took;
    }

    /// `{"<stage>_ms": …, "total_ms": …}`: medians over all rounds.
    pub fn to_json(&self) -> Value {
        let named = self.medians().map(|(name, ms)| (format!("{name}_ms"), json!(ms)));
        Value::Object(named.collect::<Map<_, _>>())
    }

    /// One line for every stage and one for the total.
    pub fn to_text(&self) -> String {
        self.medians().map(|(name, ms)| format!("{name:>10} {ms:>10.3} ms\n")).collect()
    }

    fn medians(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let stages = self.stages.iter().map(|(name, times)| (*name, times));
        stages.chain([("total", &self.totals)]).map(|(name, times)| (name, median_ms(times)))
    }
}

/// The median in milliseconds, to a microsecond; 0 of nothing.
fn median_ms(times: &[Duration]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_unstable();
    let middle = sorted.len() / 2;
    let median = match sorted.len() {
        0 => Duration::ZERO,
        count if count % 2 == 1 => sorted[middle],
        _ => (sorted[middle - 1] + sorted[middle]) / 2,
    };
    (median.as_secs_f64() * 1e6).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timings_are_medians_over_rounds_and_sums_within_one() {
        let mut timings = Timings::default();
        for ms in [5, 1, 3] {
            timings.round(|t| {
                t.note("read", Duration::from_millis(ms));
                t.note("read", Duration::from_millis(1));
            });
        }
        let shown = timings.to_json();
        assert_eq!(shown["read_ms"], 4.0);
        assert!(shown["total_ms"].is_number());
        assert_eq!(median_ms(&[1, 4].map(Duration::from_millis)), 2.5);
        assert_eq!(median_ms(&[]), 0.0);
    }
}
