//! STL, OBJ and PLY as other programs write them, and what is said about what cannot be read.

use crate::support::*;
use glam::Vec3;
use mesh::io::{Format, Notice, Place, ReadError};

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

#[test]
fn ascii_stl_may_be_upper_case_with_crlf_tabs_a_byte_order_mark_and_several_solids() {
    let facet = "\tFACET NORMAL nan(ind) 0 0\r\n\r\n OUTER  LOOP\r\nVERTEX 0 0 0\r\nVertex 1E0 0 0\r\nvertex 0 +1. 0\r\nEndLoop\r\nENDFACET\r\n";
    let text =
        format!("\u{FEFF}SOLID facet of ünknown\r\n{facet}ENDSOLID x y\r\n\r\nsolid\r\n{facet}endsolid\r\n");
    let loaded = load(text.as_bytes(), Format::Stl).expect("it is valid");
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 1, 2]]);
    assert_eq!(loaded.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!((loaded.format, loaded.notices.len()), (Format::StlAscii, 0));
}

#[test]
fn a_binary_stl_whose_header_begins_with_solid_is_read_as_binary() {
    let mut bytes = bytes_of(&cube(1.0), Format::Stl);
    bytes[..12].copy_from_slice(b"solid facet ");
    assert_eq!(load(&bytes, Format::Stl).expect("it is valid").format, Format::Stl);
    bytes.extend_from_slice(b"more");
    let loaded = load(&bytes, Format::Stl).expect("what follows is ignored");
    assert_eq!(loaded.notices, [Notice::TrailingBytes { at: 684, count: 4 }]);
}

#[test]
fn ascii_stl_errors_name_the_line_the_value_and_what_would_be_right() {
    let with = |vertex: &str| {
        let text = format!(
            "solid\nfacet normal 0 0 1\nouter loop\n{vertex}\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid"
        );
        complaint(text.as_bytes(), Format::Stl)
    };
    assert_eq!(
        with("vertex 1 0,5 0"),
        "line 4: found \"0,5\", expected the y coordinate, a number like 12.5 or -3e-2"
    );
    assert_eq!(
        with("vertex 1 2 -inf"),
        "line 4: the z coordinate is -inf; coordinates must be finite numbers below 3.4e38"
    );
    assert!(with("vertex 1e39 2 3").contains("the x coordinate is 1e39"));
    assert_eq!(with("corner 1 2 3"), "line 4: found \"corner\", expected vertex");
    let cut = complaint(b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0", Format::Stl);
    assert_eq!(cut, "line 4: the file ends too early: a coordinate should follow");
}

#[test]
fn triangles_without_three_corners_are_left_out_and_counted() {
    let facet = |z| {
        format!("facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 {z} vertex 1 0 0 endloop endfacet\n")
    };
    let text = format!("solid\n{}{}{}", facet(1), facet(0), facet(0));
    let loaded = load(text.as_bytes(), Format::Stl).expect("one triangle is left");
    assert_eq!(loaded.mesh.triangles.len(), 1);
    let expected = [Notice::MissingEnd { line: 4 }, Notice::CollapsedTriangles { count: 2, first: 2 }];
    assert_eq!(loaded.notices, expected);
}

#[test]
fn obj_faces_may_have_textures_normals_negative_indices_and_continued_lines() {
    let text = b"# comment\r\nmtllib missing.mtl\r\nv 0 0 0 1.0 0.5 0.5\r\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng a b\n\
        f 1/1/1 3/1/1 2/1/1 # end\nv 0 0 1\nf 1//1 2//1 -1//1\nf 1 \\\n 4 \\\n 3\nf -3 -2 -1\nl 1 2\n";
    let loaded = load(text, Format::Obj).expect("it is valid");
    assert_eq!(
        loaded.mesh.triangles,
        TETRAHEDRON.map(|[a, b, c]| if a == 0 && b == 3 { [0, 3, 2] } else { [a, b, c] })
    );
    assert_eq!(loaded.notices, [Notice::SkippedStatements { count: 1, first: 16 }]);
}

#[test]
fn obj_polygons_are_cut_so_that_the_solid_keeps_its_volume() {
    // A prism over an L, with faces of six and four corners.
    let l = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    let mut text = String::new();
    for z in [0, 3] {
        for [x, y] in l {
            text += &format!("v {x} {y} {z}\n");
        }
    }
    text += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
    for i in 1..=6 {
        let next = i % 6 + 1;
        text += &format!("f {i} {next} {} {}\n", next + 6, i + 6);
    }
    let loaded = load(text.as_bytes(), Format::Obj).expect("it is valid");
    assert_eq!((loaded.mesh.triangles.len(), loaded.notices.len()), (20, 0));
    assert_eq!(volume6(&loaded.mesh), 54.0, "6 times the area 3 times the height 3");
}

#[test]
fn obj_faces_may_come_before_their_vertices() {
    let loaded =
        load(b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", Format::Obj).expect("it is unusual, but clear");
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn obj_errors_name_the_line_and_the_index_as_written() {
    let with = |face: &str| complaint(format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n").as_bytes(), Format::Obj);
    assert_eq!(with("f 1 2 4"), "line 4: a face uses vertex 4, but vertices run from 1 to 3");
    assert_eq!(with("f 1 2 -4"), "line 4: a face uses vertex -4, but vertices run from 1 to 3");
    assert!(with("f 1 2 0").starts_with("line 4: found \"0\", expected a vertex number"));
    assert!(with("f 1 2 9223372036854775807").contains("vertex 9223372036854775807"));
    assert!(with("f 1 2 -9223372036854775808").contains("vertex -9223372036854775808"));
    assert!(with("f 1 2 99999999999999999999").contains("expected a vertex number"));
    assert!(with("f 1 2").contains("a face with 2 corners, expected at least 3"));
    assert!(with("v 1 2").contains("a vertex without a z coordinate"));
    assert!(with("").contains("3 vertices, but no faces"));
    assert!(matches!(
        load(b"v 0 0 nan\n", Format::Obj),
        Err(ReadError::NotFinite { place: Place::Line(1), axis: 'z', .. })
    ));
    assert!(complaint(b"Dear reader,\n\nthis is a letter.\n", Format::Obj).contains("perhaps no OBJ file"));
}

#[test]
fn endless_lines_are_refused() {
    for (named, start) in
        [(Format::Obj, "v 0 0 0\n"), (Format::Stl, "solid\n"), (Format::Ply, "ply\ncomment ")]
    {
        let text = start.to_owned() + &" 1".repeat(1 << 20);
        assert!(complaint(text.as_bytes(), named).contains("bytes in one line"), "{named}");
    }
}

/// A tetrahedron with everything a PLY file may carry around it, in the given encoding.
fn ply_tetrahedron(encoding: &str) -> Vec<u8> {
    let header = format!(
        "ply\r\nformat {encoding} 1.0\r\ncomment by hand\r\nelement camera 1\r\nproperty list uint8 float64 pose\r\n\
         element vertex 4\r\nproperty uchar red\r\nproperty double x\r\nproperty int16 y\r\nproperty float z\r\n\
         element face 4\r\nproperty list ushort double uv\r\nproperty list uchar uint vertex_index\r\nend_header\r\n"
    );
    let mut bytes = header.into_bytes();
    let vertices: [[i16; 3]; 4] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    if encoding == "ascii" {
        let mut text = String::from("2 0.5 1e-3\n");
        for [x, y, z] in vertices {
            text += &format!("255 {x}.0 {y} {z}\n");
        }
        for [a, b, c] in TETRAHEDRON {
            text += &format!("0 3 {a} {b} {c}\n");
        }
        bytes.extend(text.into_bytes());
        return bytes;
    }
    let mut put = |number: &[u8]| {
        let ordered: Vec<u8> =
            if encoding.contains("big") { number.iter().rev().copied().collect() } else { number.to_vec() };
        bytes.extend(ordered);
    };
    put(&[2]);
    put(&0.5f64.to_le_bytes());
    put(&1e-3f64.to_le_bytes());
    for [x, y, z] in vertices {
        put(&[255]);
        put(&f64::from(x).to_le_bytes());
        put(&y.to_le_bytes());
        put(&f32::from(z).to_le_bytes());
    }
    for corners in TETRAHEDRON {
        put(&0u16.to_le_bytes());
        put(&[3]);
        for corner in corners {
            put(&corner.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn ply_is_read_in_all_three_encodings_with_foreign_elements_and_properties() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let bytes = ply_tetrahedron(encoding);
        let loaded = load(&bytes, Format::Ply).unwrap_or_else(|error| panic!("{encoding}: {error}"));
        assert_eq!(loaded.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z], "{encoding}");
        assert_eq!(loaded.mesh.triangles, TETRAHEDRON, "{encoding}");
        for length in 0..bytes.len() - 1 {
            assert!(load(&bytes[..length], Format::Ply).is_err(), "{encoding}: cut at byte {length}");
        }
    }
}

#[test]
fn ply_errors_name_the_line_or_byte() {
    let with = |body: &str| {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n{body}"
        );
        complaint(text.as_bytes(), Format::Ply)
    };
    assert_eq!(
        with("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
        "line 13: a face uses vertex 3, but vertices run from 0 to 2"
    );
    assert_eq!(
        with("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
        "line 13: a face uses vertex -1, but vertices run from 0 to 2"
    );
    assert!(with("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n").starts_with("line 11: the y coordinate is nan"));
    assert!(
        with("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n")
            .starts_with("line 13: found -3, expected the length of a list")
    );
    assert!(
        with("0 0 0\n1 0 0\n0 1 0\n2 0 1\n")
            .contains("line 13: found a face with 2 corners, expected at least 3")
    );
    let mut binary = ply_tetrahedron("binary_little_endian");
    let at = binary.len() - 4;
    binary[at] = 200;
    assert!(
        complaint(&binary, Format::Ply).ends_with("a face uses vertex 200, but vertices run from 0 to 3")
    );
    let header = |lines: &str| complaint(format!("ply\n{lines}").as_bytes(), Format::Ply);
    assert!(header("format ascii 2.0\n").starts_with("line 2: found \"format ascii 2.0\""));
    assert!(header("format ascii 1.0\nproperty float x\n").contains("an element before its properties"));
    assert!(header("format ascii 1.0\nelement vertex -1\n").contains("element NAME COUNT"));
    assert!(header("end_header\n").contains("a format line before it"));
    assert!(header("format ascii 1.0\n").contains("no end_header"));
    assert!(complaint(b"mesh\n", Format::Ply).contains("`ply`, the first line"));
}
