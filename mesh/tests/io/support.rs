//! What the tests of mesh files share: random meshes, and files in memory.

use std::io::{Cursor, Write};

use glam::Vec3;
use mesh::Mesh;
use mesh::io::{Attachments, Format, Loaded, ReadError, ReadLimits, read, write};
use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

/// All formats, with a name for messages.
pub const FORMATS: [Format; 5] = [Format::Stl, Format::StlAscii, Format::Obj, Format::Ply, Format::ThreeMf];

/// A small generator whose numbers are the same everywhere (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    /// Any finite float: all signs and exponents, subnormals too.
    pub fn float(&mut self) -> f32 {
        loop {
            let value = f32::from_bits(self.next() as u32);
            if value.is_finite() {
                return value;
            }
        }
    }
}

/// Random vertices of every size and random triangles without repeated corners.
pub fn random_mesh(seed: u64) -> Mesh {
    let mut random = Random(seed);
    let vertices = 3 + random.below(40);
    let positions = (0..vertices).map(|_| Vec3::from([(); 3].map(|()| random.float()))).collect();
    let triangles = (0..1 + random.below(60))
        .map(|_| {
            let first = random.below(vertices);
            let step = 1 + random.below((vertices - 1) / 2);
            [first, (first + step) % vertices, (first + 2 * step) % vertices].map(|i| i as u32)
        })
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .chain([[0, 1, 2]])
        .collect();
    Mesh { positions, triangles }
}

/// A cube from 0 to `side`, facing outwards.
pub fn cube(side: f32) -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * side;
    let triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    Mesh { positions: (0..8).map(corner).collect(), triangles }
}

/// Six times the signed volume.
pub fn volume6(mesh: &Mesh) -> f64 {
    let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum()
}

pub fn bytes_of(mesh: &Mesh, format: Format) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    write(&mut file, mesh, format, &Attachments::default()).expect("the mesh is writable");
    file.into_inner()
}

pub fn load(bytes: &[u8], named: Format) -> Result<Loaded, ReadError> {
    read(Cursor::new(bytes), named, &ReadLimits::default())
}

/// The error, as the user sees it.
pub fn complaint(bytes: &[u8], named: Format) -> String {
    load(bytes, named).expect_err("the file should be refused").to_string()
}

/// A package of these parts.
pub fn zipped(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (name, content) in parts {
        zip.start_file(*name, options).expect("writing to memory");
        zip.write_all(content).expect("writing to memory");
    }
    zip.finish().expect("writing to memory").into_inner()
}

/// A package with this XML inside its model element.
pub fn package(attributes: &str, inside: &str) -> Vec<u8> {
    let model = format!(
        "<model {attributes} xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">{inside}</model>"
    );
    zipped(&[("3D/3dmodel.model", model.as_bytes())])
}
