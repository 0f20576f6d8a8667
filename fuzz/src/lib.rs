//! What the fuzz targets share.
//!
//! A target is one line: `trullo_fuzz::target!(|data| …)` with what to do with the bytes. Panics, wrong promises,
//! more than half a gigabyte of memory, and (by `./run`) more than two seconds for one input are finds.

mod scene;
mod strokes;

use std::io::Cursor;

use mesh::Mesh;
use mesh::io::{Attachments, Format, ReadLimits, close_cracks, read_as_written, write};

pub use scene::read_scene;
pub use strokes::{draw, read_strokes};

#[doc(hidden)]
pub use libfuzzer_sys;

/// Memory that the readers may use.
pub const MEMORY: usize = 500 << 20;

/// Ends the program, and so keeps the input, when more memory is asked for than [`MEMORY`].
#[global_allocator]
static ALLOCATOR: cap::Cap<std::alloc::System> = cap::Cap::new(std::alloc::System, MEMORY);

/// Allows for what matrix products ask for besides [`MEMORY`], of which they touch only what they need: twice the
/// largest cache for each thread.
pub(crate) fn allow_for_products() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let caches = (0..8).filter_map(|i| {
            let path = format!("/sys/devices/system/cpu/cpu0/cache/index{i}/size");
            std::fs::read_to_string(path).ok()?.trim().strip_suffix('K')?.parse::<usize>().ok()
        });
        let threads = 1 + std::thread::available_parallelism().map_or(1, usize::from);
        let space = threads * 2 * (caches.max().unwrap_or(0) << 10);
        ALLOCATOR.set_limit(MEMORY + space).expect("less is in use");
    });
}

/// Makes a program that feeds bytes to a function.
#[macro_export]
macro_rules! target {
    (|$data:ident| $body:expr) => {
        $crate::libfuzzer_sys::fuzz_target!(|$data: &[u8]| {
            $body;
        });
    };
}

/// Reads a mesh; if there is one, it must be writable and come back the same, and so with its cracks closed.
pub fn read_mesh(data: &[u8], named: Format) {
    let Ok(mut loaded) = read_as_written(Cursor::new(data), named, &ReadLimits::default()) else {
        return;
    };
    assert_comes_back(&loaded.mesh);
    if close_cracks(&mut loaded.mesh).is_some() {
        assert_comes_back(&loaded.mesh);
    }
}

fn assert_comes_back(mesh: &Mesh) {
    let mut file = Cursor::new(Vec::new());
    write(&mut file, mesh, Format::Ply, &Attachments::default()).expect("what was read is writable");
    let back = read_as_written(&mut file, Format::Ply, &ReadLimits::default())
        .expect("what was written is readable");
    assert!(back.mesh == *mesh, "the mesh changed");
}

/// A 3MF package whose model is these bytes, unpacked and so without a checksum in the fuzzer's way.
pub fn package_of(model: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    zip.start_file("3D/3dmodel.model", options).expect("writing to memory");
    zip.write_all(model).expect("writing to memory");
    zip.finish().expect("writing to memory").into_inner()
}
