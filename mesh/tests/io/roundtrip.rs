//! What is written comes back: meshes exactly, attachments whole, bytes the same every time.

use std::io::Cursor;

use crate::support::*;
use glam::Vec3;
use mesh::Mesh;
use mesh::io::{
    Attachments, Format, Material, ReadLimits, TriangleMaterials, WriteError, read, read_as_written, write,
};

/// The corners of each triangle: what an STL file holds. Adding zero makes -0 and 0 the same.
fn corners(mesh: &Mesh) -> Vec<[[u32; 3]; 3]> {
    let corner = |i: u32| (mesh.positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    mesh.triangles.iter().map(|triangle| triangle.map(corner)).collect()
}

#[test]
fn every_format_gives_random_meshes_back_to_the_last_bit() {
    for seed in 0..300 {
        let mesh = random_mesh(seed);
        for format in FORMATS {
            let bytes = bytes_of(&mesh, format);
            let back = read_as_written(Cursor::new(&bytes), format, &ReadLimits::default())
                .unwrap_or_else(|error| panic!("seed {seed}, {format}: {error}"));
            assert_eq!(back.format, format, "seed {seed}");
            assert_eq!(back.notices, [], "seed {seed}, {format}");
            assert_eq!(corners(&back.mesh), corners(&mesh), "seed {seed}, {format}: other triangles");
            if !matches!(format, Format::Stl | Format::StlAscii) {
                assert_eq!(back.mesh, mesh, "seed {seed}, {format}: other indices");
            }
        }
    }
}

#[test]
fn the_same_mesh_gives_the_same_bytes() {
    let mesh = random_mesh(7);
    for format in FORMATS {
        assert_eq!(bytes_of(&mesh, format), bytes_of(&mesh, format), "{format}");
    }
}

#[test]
fn stl_corners_in_one_place_are_welded_in_order_of_appearance() {
    for format in [Format::Stl, Format::StlAscii] {
        let soup = Mesh {
            positions: [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [-0., 0., 0.], [0., 1., -0.], [0., 0., 1.]]
                .map(Vec3::from)
                .to_vec(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
        };
        let back = load(&bytes_of(&soup, format), format).expect("the file is whole").mesh;
        assert_eq!(back.positions, [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]);
        assert_eq!(back.triangles, [[0, 1, 2], [0, 2, 3]]);
    }
}

#[test]
fn welding_on_request_joins_split_vertices_and_drops_unused_ones() {
    let split = Mesh {
        positions: [[9., 9., 9.], [0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 0., 0.], [0., 0., 1.]]
            .map(Vec3::from)
            .to_vec(),
        triangles: vec![[1, 2, 3], [1, 5, 4]],
    };
    let (welded, gone) = mesh::io::weld(&split);
    assert_eq!((welded.triangles, gone), (vec![[0, 1, 2], [0, 3, 1]], 2));
}

#[test]
fn a_3mf_file_carries_scene_title_and_metadata() {
    let attachments = Attachments {
        title: Some("Pawn & <king>, \"ζ\"\r\n]]>".to_owned()),
        scene: Some(b"{\"format\": \"trullo\"}\0\xFF".to_vec()),
        metadata: vec![
            ("Designer".to_owned(), "  A 'child'  ".to_owned()),
            ("cell-size_mm.v2".to_owned(), "0.25".to_owned()),
        ],
        ..Attachments::default()
    };
    let mut file = Cursor::new(Vec::new());
    write(&mut file, &cube(10.0), Format::ThreeMf, &attachments).expect("the mesh is writable");
    let back = read(&mut file, Format::ThreeMf, &ReadLimits::default()).expect("the file is whole");
    assert_eq!(back.attachments, attachments);
}

#[test]
fn a_3mf_file_is_what_the_core_specification_asks_for() {
    use std::io::Read;
    let attachments = Attachments {
        title: Some("Tip".to_owned()),
        scene: Some(b"{}".to_vec()),
        metadata: vec![("Cells".to_owned(), "64".to_owned())],
        ..Attachments::default()
    };
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::new(0.1, -2.5e-7, 3e10), Vec3::ONE],
        triangles: vec![[0, 1, 2]],
    };
    let mut file = Cursor::new(Vec::new());
    write(&mut file, &mesh, Format::ThreeMf, &attachments).expect("the mesh is writable");
    let mut archive = zip::ZipArchive::new(file).expect("it is a zip file");
    let mut part = |name: &str| {
        let mut text = String::new();
        archive.by_name(name).expect(name).read_to_string(&mut text).expect("it is text");
        text
    };
    assert!(part("[Content_Types].xml").contains(
        "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
    ));
    assert!(part("_rels/.rels").contains(
        "<Relationship Target=\"/Metadata/scene.trullo\" Id=\"scene\" \
         Type=\"http://schemas.openxmlformats.org/package/2006/relationships/mustpreserve\"/>"
    ));
    assert_eq!(part("Metadata/scene.trullo"), "{}");
    let expected = r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:trullo="urn:trullo:metadata">
 <metadata name="Application">Trullo</metadata>
 <metadata name="Title" preserve="1">Tip</metadata>
 <metadata name="trullo:Cells" preserve="1">64</metadata>
 <resources>
  <object id="1" type="model">
   <mesh>
    <vertices>
<vertex x="0" y="0" z="0"/>
<vertex x="0.1" y="-2.5e-7" z="3e10"/>
<vertex x="1" y="1" z="1"/>
    </vertices>
    <triangles>
<triangle v1="0" v2="1" v3="2"/>
    </triangles>
   </mesh>
  </object>
 </resources>
 <build>
  <item objectid="1"/>
 </build>
</model>
"#;
    assert_eq!(part("3D/3dmodel.model"), expected);
}

#[test]
fn the_other_formats_are_written_as_their_readers_expect() {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 0.5, 0.0)],
        triangles: vec![[0, 1, 2]],
    };
    let text = |format| String::from_utf8(bytes_of(&mesh, format)).expect("it is text");
    assert_eq!(text(Format::Obj), "# Trullo, millimetres, z up\nv 0 0 0\nv 2 0 0\nv 0 0.5 0\nf 1 2 3\n");
    assert_eq!(
        text(Format::StlAscii),
        "solid trullo\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 0.5 0\nendloop\nendfacet\n\
         endsolid trullo\n"
    );
    let binary = bytes_of(&mesh, Format::Stl);
    assert_eq!(binary.len(), 134);
    assert_eq!(&binary[..31], b"Trullo, binary STL, millimetres");
    assert_eq!(binary[80..84], [1, 0, 0, 0]);
    assert_eq!(binary[92..96], 1f32.to_le_bytes(), "the z coordinate of the normal");
    let ply = bytes_of(&mesh, Format::Ply);
    assert!(ply.starts_with(b"ply\nformat binary_little_endian 1.0\n"));
    assert!(ply.ends_with(&[3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]));
}

#[test]
fn a_mesh_that_no_reader_could_take_is_not_written() {
    let refused = |mesh: Mesh| {
        for format in FORMATS {
            let mut file = Cursor::new(Vec::new());
            let error = write(&mut file, &mesh, format, &Attachments::default());
            error.expect_err("the mesh should be refused");
            assert!(file.into_inner().is_empty(), "{format}: something was written");
        }
    };
    refused(Mesh::default());
    refused(Mesh { triangles: Vec::new(), ..cube(1.0) });
    let mut bad = cube(1.0);
    bad.positions[3].y = f32::NAN;
    refused(bad);
    let mut bad = cube(1.0);
    bad.positions[7].z = f32::INFINITY;
    refused(bad);
    let mut bad = cube(1.0);
    bad.triangles[5] = [0, 8, 1];
    refused(bad);
    let mut bad = cube(1.0);
    bad.triangles[5] = [0, 2, 2];
    refused(bad);
}

#[test]
fn metadata_that_xml_cannot_hold_is_refused_by_name() {
    for (name, value) in [
        ("a b", "x"),
        ("", "x"),
        ("1st", "x"),
        ("a:b", "x"),
        ("Application", "x"),
        ("ok", "\u{1}"),
        ("Title", "x"),
    ] {
        let attachments = Attachments {
            title: Some("T".to_owned()),
            metadata: vec![(name.to_owned(), value.to_owned())],
            ..Attachments::default()
        };
        let mut file = Cursor::new(Vec::new());
        let error = write(&mut file, &cube(1.0), Format::ThreeMf, &attachments).expect_err(name);
        assert!(matches!(error, WriteError::Metadata { name: found, .. } if found == name), "{name}");
        assert!(file.into_inner().is_empty());
    }
}

/// The twelve triangles of a cube of these materials.
fn of_two_materials(of_triangles: Vec<u32>, name: &str) -> Result<Cursor<Vec<u8>>, WriteError> {
    let material = |name: &str, color| Material { name: name.to_owned(), color };
    let materials = vec![material("model", [1, 0xE2, 255]), material(name, [0; 3])];
    let materials = Some(TriangleMaterials { materials, of_triangles });
    let mut file = Cursor::new(Vec::new());
    let attachments = Attachments { materials, ..Attachments::default() };
    write(&mut file, &cube(1.0), Format::ThreeMf, &attachments).map(|()| file)
}

#[test]
fn triangles_of_a_3mf_file_say_what_they_are_made_of() {
    use std::io::Read;
    let of_triangles = (0..12).map(|n| u32::from(n == 3 || n == 11)).collect();
    let mut file = of_two_materials(of_triangles, "\"grown\" & <held>").expect("it can be written");
    let back = read(&mut file, Format::ThreeMf, &ReadLimits::default()).expect("the file is whole");
    assert_eq!((back.mesh, back.notices), (cube(1.0), Vec::new()));
    let mut archive = zip::ZipArchive::new(file).expect("it is a zip file");
    let mut text = String::new();
    let mut part = archive.by_name("3D/3dmodel.model").expect("the model");
    part.read_to_string(&mut text).expect("it is text");
    let resource = "<basematerials id=\"2\">\n   <base name=\"model\" displaycolor=\"#01E2FF\"/>\n   \
        <base name=\"&quot;grown&quot; &amp; &lt;held&gt;\" displaycolor=\"#000000\"/>\n  </basematerials>\n  \
        <object id=\"1\" type=\"model\" pid=\"2\" pindex=\"0\">";
    assert!(text.contains(resource), "{text}");
    let triangles: Vec<&str> = text.lines().filter(|line| line.starts_with("<triangle ")).collect();
    let marked = (0..12).filter(|n| triangles[*n].ends_with(" pid=\"2\" p1=\"1\"/>"));
    assert_eq!((triangles.len(), marked.collect::<Vec<_>>()), (12, vec![3, 11]), "{text}");
}

#[test]
fn materials_that_do_not_fit_the_mesh_are_refused() {
    for (of_triangles, name, words) in [
        (vec![0; 11], "grown", "each triangle needs one"),
        (vec![2; 12], "grown", "one that is not there"),
        (vec![1; 12], "", "each needs a name"),
        (vec![1; 12], "\u{7}", "without control characters"),
    ] {
        let error = of_two_materials(of_triangles, name).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
}
