//! One command's work: its stages, their times, and how it is stopped.

use crate::failure::Failure;
use crate::folder::MakeFile;
use crate::progress::Meter;
use crate::timings::Timings;
use polygonizer::Cancel;
use std::time::Instant;

/// What a verb works with.
#[derive(Debug)]
pub struct Job<'a> {
    timings: &'a mut Timings,
    meter: &'a Meter,
    cancel: &'a Cancel,
}

impl<'a> Job<'a> {
    /// A job whose stages go to `timings` and `meter` and end at the next chance after `cancel`.
    pub fn new(timings: &'a mut Timings, meter: &'a Meter, cancel: &'a Cancel) -> Self {
        Self { timings, meter, cancel }
    }

    /// Does one stage of the work.
    ///
    /// Errors: the work's, and [`Failure::Interrupted`] if that was asked for before or meanwhile.
    pub fn stage<T>(
        &mut self,
        name: &'static str,
        work: impl FnOnce(&Watch) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let watch = Watch { meter: self.meter, cancel: self.cancel };
        watch.go_on()?;
        self.meter.begin(name);
        let start = Instant::now();
        let result = work(&watch);
        self.timings.note(name, start.elapsed());
        self.meter.end();
        watch.go_on()?;
        result
    }

    /// Writes a file, unless the job is to stop: it is all there or not at all. Stage "write".
    pub fn write(&mut self, path: &std::path::Path, content: &[u8]) -> Result<(), Failure> {
        let watch = Watch { meter: self.meter, cancel: self.cancel };
        watch.go_on()?;
        let start = Instant::now();
        let result = crate::output::write_file(path, content, self.cancel);
        self.timings.note("write", start.elapsed());
        result
    }

    /// Makes `count` files and writes them as a new folder: it is all there or not at all. Stage "write".
    pub fn write_folder(
        &mut self,
        path: &std::path::Path,
        count: usize,
        make: &MakeFile,
    ) -> Result<(), Failure> {
        self.stage("write", |watch| crate::folder::write(path, count, make, watch))
    }
}

/// How a stage tells how far it is and learns that it is to stop.
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    meter: &'a Meter,
    /// For rooms that take it.
    pub cancel: &'a Cancel,
}

impl Watch<'_> {
    /// Tells how much of the stage is done, from 0 to 1.
    pub fn report(&self, share: f32) {
        self.meter.report(share);
    }

    /// Errors: [`Failure::Interrupted`] if somebody asked to stop.
    pub fn go_on(&self) -> Result<(), Failure> {
        if self.cancel.is_cancelled() { Err(Failure::Interrupted) } else { Ok(()) }
    }
}
