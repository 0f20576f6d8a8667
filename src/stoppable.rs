//! Readers and writers that end when somebody asks to stop.

use polygonizer::Cancel;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Hands everything on, and fails as soon as `cancel` says so; [`crate::job::Job`] tells that from other failures.
///
/// A writer fails only once: what comes after that is thrown away, so that whoever closes up archives can do so.
#[derive(Debug)]
pub struct Stoppable<'a, T> {
    inner: T,
    cancel: &'a Cancel,
    has_failed: bool,
}

impl<'a, T> Stoppable<'a, T> {
    /// What hands on to `inner`.
    pub fn new(inner: T, cancel: &'a Cancel) -> Self {
        Self { inner, cancel, has_failed: false }
    }

    /// What it handed on to.
    pub fn into_inner(self) -> T {
        self.inner
    }

    fn go_on(&mut self) -> io::Result<()> {
        self.has_failed = self.cancel.is_cancelled();
        if self.has_failed { Err(io::Error::other("stopped")) } else { Ok(()) }
    }
}

impl<T: Read> Read for Stoppable<'_, T> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        self.go_on()?;
        self.inner.read(to)
    }
}

impl<T: Write> Write for Stoppable<'_, T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.has_failed {
            return Ok(bytes.len());
        }
        self.go_on()?;
        self.inner.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<T: Seek> Seek for Stoppable<'_, T> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}
