//! Broken files: none panics, hangs, or is believed.

use std::time::{Duration, Instant};

use crate::support::*;
use mesh::io::{Attachments, Format, Loaded, ReadError, ReadLimits, read, write};

/// Whatever a reader hands out must keep its promises.
fn check_promises(loaded: &Loaded, what: &str) {
    assert!(!loaded.mesh.triangles.is_empty(), "{what}: no triangles");
    let mut file = std::io::Cursor::new(Vec::new());
    let written = write(&mut file, &loaded.mesh, Format::Ply, &Attachments::default());
    assert!(written.is_ok(), "{what}: {}", written.expect_err("it was not ok"));
}

fn try_reading(bytes: &[u8], format: Format, what: &str) -> bool {
    let begun = Instant::now();
    let result = load(bytes, format);
    assert!(begun.elapsed() < Duration::from_secs(2), "{what}: took {:?}", begun.elapsed());
    match &result {
        Ok(loaded) => check_promises(loaded, what),
        Err(error) => assert!(!error.to_string().is_empty(), "{what}"),
    }
    result.is_ok()
}

#[test]
fn files_cut_at_every_percent_of_their_length_are_refused() {
    for format in FORMATS {
        let whole = bytes_of(&random_mesh(11), format);
        for percent in 0..100 {
            let length = whole.len() * percent / 100;
            let read = try_reading(&whole[..length], format, &format!("{format} cut at {percent} %"));
            // Text without an end mark may be cut between two lines; the rest is a file like any other.
            let cannot_tell = matches!(format, Format::Obj | Format::StlAscii);
            assert!(!read || cannot_tell, "{format} cut at {percent} % was believed");
        }
    }
}

#[test]
fn flipped_bits_and_foreign_bytes_never_panic() {
    for format in FORMATS {
        for seed in 0..150 {
            let mut random = Random(seed);
            let mut bytes = bytes_of(&random_mesh(seed), format);
            for _ in 0..1 + random.below(8) {
                let at = random.below(bytes.len());
                match random.below(4) {
                    0 => bytes[at] ^= 1 << random.below(8),
                    1 => bytes[at] = random.next() as u8,
                    2 => {
                        bytes.remove(at);
                    }
                    _ => bytes.insert(at, b"\0\xFF \n-9/<"[random.below(8)]),
                }
            }
            try_reading(&bytes, format, &format!("{format}, seed {seed}"));
        }
    }
}

#[test]
fn any_format_can_be_read_under_any_name() {
    for format in FORMATS {
        let bytes = bytes_of(&cube(10.0), format);
        for named in FORMATS {
            match load(&bytes, named) {
                Ok(loaded) => {
                    assert_eq!(loaded.format, format);
                    assert_eq!(loaded.mesh.triangles.len(), 12, "{format} named {named}");
                    let renamed = named.extension() != format.extension();
                    assert_eq!(loaded.notices.len(), usize::from(renamed), "{format} named {named}");
                }
                // OBJ has no mark of its own.
                Err(_) => assert_eq!(format, Format::Obj, "{format} named {named}"),
            }
        }
    }
}

#[test]
fn counts_in_headers_are_not_believed() {
    let mut stl = bytes_of(&cube(1.0), Format::Stl);
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(complaint(&stl, Format::Stl).contains("announces 4294967295 triangles"));

    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for (element, count) in
            [("vertex", "4294967295"), ("face", "18446744073709551615"), ("other", "99999999999")]
        {
            let properties = match element {
                "face" => "property list uchar int vertex_indices\n",
                _ => "property float x\nproperty float y\nproperty float z\n",
            };
            let ply = format!(
                "ply\nformat {encoding} 1.0\nelement {element} {count}\n{properties}end_header\n1 2 3\n"
            );
            assert!(complaint(ply.as_bytes(), Format::Ply).contains("line 3"), "{encoding} {element}");
        }
        let empty = format!("ply\nformat {encoding} 1.0\nelement vertex 4294967295\nend_header\n");
        try_reading(empty.as_bytes(), Format::Ply, "an element without properties");
    }
    let list = b"ply\nformat binary_little_endian 1.0\nelement other 1\nproperty list uint double p\nend_header\n\xFF\xFF\xFF\xFF";
    assert!(matches!(load(list, Format::Ply), Err(ReadError::Truncated { .. })));
}

#[test]
fn limits_are_kept_in_every_format() {
    let mesh = cube(1.0);
    for format in FORMATS {
        let bytes = bytes_of(&mesh, format);
        let with = |limits: ReadLimits| read(std::io::Cursor::new(&bytes), format, &limits);
        let all = ReadLimits::default();
        with(ReadLimits { max_triangles: 12, max_vertices: 8, max_bytes: bytes.len().max(4096) as u64 })
            .unwrap_or_else(|error| panic!("{format}: {error}"));
        for limits in [
            ReadLimits { max_triangles: 11, ..all },
            ReadLimits { max_vertices: 7, ..all },
            ReadLimits { max_bytes: bytes.len() as u64 - 1, ..all },
        ] {
            assert!(matches!(with(limits), Err(ReadError::TooLarge { .. })), "{format}: {limits:?}");
        }
    }
}

#[test]
fn a_reader_that_fails_is_an_error_and_not_a_broken_file() {
    struct Broken;
    impl std::io::Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("pulled out"))
        }
    }
    impl std::io::Seek for Broken {
        fn seek(&mut self, _: std::io::SeekFrom) -> std::io::Result<u64> {
            Ok(1000)
        }
    }
    for format in FORMATS {
        let error = read(Broken, format, &ReadLimits::default()).expect_err("nothing can be read");
        assert_eq!(error.to_string(), "the file cannot be read: pulled out");
    }
}
