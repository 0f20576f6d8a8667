//! 3MF packages: units, transforms, components, split models, and packages made to do harm.

use std::time::{Duration, Instant};

use crate::support::*;
use glam::Vec3;
use mesh::io::{Format, Loaded, Notice, ReadError};

const TETRAHEDRON: &str = "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>\
    <vertex x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1\"/></vertices><triangles>\
    <triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/>\
    <triangle v1=\"0\" v2=\"3\" v3=\"2\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/></triangles></mesh>";

fn object(id: u32, content: &str) -> String {
    format!("<object id=\"{id}\">{content}</object>")
}

fn model(resources: &str, build: &str) -> String {
    format!("<resources>{resources}</resources><build>{build}</build>")
}

fn loaded(bytes: &[u8]) -> Loaded {
    load(bytes, Format::ThreeMf).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(inside: &str) -> String {
    complaint(&package("", inside), Format::ThreeMf)
}

#[test]
fn every_unit_becomes_millimetres_transforms_included() {
    for (unit, millimetres) in [
        ("micron", 0.001),
        ("millimeter", 1.0),
        ("centimeter", 10.0),
        ("inch", 25.4),
        ("foot", 304.8),
        ("meter", 1000.0),
    ] {
        let item = "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 2 0 0\"/>";
        let bytes = package(&format!("unit=\"{unit}\""), &model(&object(1, TETRAHEDRON), item));
        let loaded = loaded(&bytes);
        let expected = [[2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 1.0]]
            .map(|p: [f64; 3]| Vec3::from(p.map(|c| (c * millimetres) as f32)));
        for (found, expected) in loaded.mesh.positions.iter().zip(expected) {
            assert!(
                (*found - expected).length() <= 1e-6 * millimetres as f32,
                "{unit}: {found} for {expected}"
            );
        }
        let told = loaded.notices.iter().any(|notice| matches!(notice, Notice::Converted { .. }));
        assert_eq!(told, unit != "millimeter");
    }
    let wrong = complaint(&package("unit=\"league\"", &model("", "")), Format::ThreeMf);
    assert!(wrong.contains("found \"league\", expected a unit: micron"), "{wrong}");
}

#[test]
fn rows_of_a_transform_multiply_points_from_the_left_and_components_nest() {
    // A quarter turn about z, x to y, then a step along x.
    let turned = "<component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 10 0 0\"/>";
    let resources = object(1, TETRAHEDRON) + &object(2, &format!("<components>{turned}</components>"));
    let item = "<item objectid=\"2\" transform=\"2 0 0 0 2 0 0 0 2 0 0 5\"/>";
    let mesh = loaded(&package("", &model(&resources, item))).mesh;
    let expected = [[20., 0., 5.], [20., 2., 5.], [18., 0., 5.], [20., 0., 7.]].map(Vec3::from);
    assert_eq!(mesh.positions, expected);
    assert_eq!(volume6(&mesh).round(), 8.0);
}

#[test]
fn a_mirrored_solid_does_not_turn_inside_out() {
    let item = "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>";
    let mesh = loaded(&package("", &model(&object(1, TETRAHEDRON), item))).mesh;
    assert_eq!(volume6(&mesh), 1.0);
}

#[test]
fn several_items_and_instances_are_all_placed_and_supports_are_not() {
    let resources =
        object(1, TETRAHEDRON) + &format!("<object id=\"7\" type=\"support\">{TETRAHEDRON}</object>");
    let items = "<item objectid=\"1\"/><item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 9 0 0\"/><item objectid=\"7\"/>";
    let loaded = loaded(&package("", &model(&resources, items)));
    assert_eq!((loaded.mesh.positions.len(), loaded.mesh.triangles.len()), (8, 8));
    assert_eq!(loaded.mesh.triangles[4], [4, 6, 5]);
    assert_eq!(loaded.notices, [Notice::SkippedObjects { count: 1 }]);
}

#[test]
fn without_build_items_every_object_is_read_once() {
    let resources = object(1, TETRAHEDRON)
        + &object(2, "<components><component objectid=\"1\"/></components>")
        + &object(3, TETRAHEDRON);
    let loaded = loaded(&package("", &model(&resources, "")));
    assert_eq!((loaded.mesh.triangles.len(), &loaded.notices[..]), (8, &[Notice::NothingBuilt][..]));
}

#[test]
fn models_split_over_parts_and_relationships_are_followed() {
    let core = "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"";
    let production = "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" requiredextensions=\"p\"";
    let component = "<components><component p:path=\"/3D/Objects/a.model\" objectid=\"5\"/></components>";
    let root = format!(
        "<model {core} {production}>{}</model>",
        model(&object(1, component), "<item objectid=\"1\"/>")
    );
    let child = format!("<model unit=\"centimeter\" {core}>{}</model>", model(&object(5, TETRAHEDRON), ""));
    let relationships = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
        <Relationship Target=\"/odd/name.model\" Id=\"a\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\
        </Relationships>";
    let bytes = zipped(&[
        ("_rels/.rels", relationships.as_bytes()),
        ("odd/Name.model", root.as_bytes()),
        ("3d/objects/A.model", child.as_bytes()),
    ]);
    assert_eq!(volume6(&loaded(&bytes).mesh), 1000.0);
}

#[test]
fn a_prefixed_core_namespace_comments_and_foreign_elements_are_understood() {
    let inside = model(&object(1, TETRAHEDRON), "<item objectid=\"1\"/>");
    let prefixed = inside.replace("</", "\u{1}").replace('<', "<c:").replace('\u{1}', "</c:");
    let foreign = "<!-- <item/> --><x:mesh><vertex x=\"nan\"/></x:mesh><?pi?>";
    let text = format!("<c:model xmlns:c=\"core\" xmlns:x=\"other\">{foreign}{prefixed}</c:model>");
    assert_eq!(loaded(&zipped(&[("3D/3dmodel.model", text.as_bytes())])).mesh.triangles.len(), 4);
}

#[test]
fn errors_name_the_part_the_byte_and_what_would_be_right() {
    let with = |from: &str, to: &str| {
        let mesh = TETRAHEDRON.replacen(from, to, 1);
        refused(&model(&object(1, &mesh), "<item objectid=\"1\"/>"))
    };
    assert!(with("x=\"1\"", "x=\"NaN\"").contains("the x coordinate is NaN"));
    assert!(with("x=\"1\"", "x=\"one\"").contains("found \"one\", expected the x coordinate"));
    assert!(with("x=\"1\"", "").contains("a vertex without all of them, expected x, y and z"));
    assert!(with("v3=\"3\"", "v3=\"4\"").contains("a face uses vertex 4, but vertices run from 0 to 3"));
    assert!(with("v3=\"3\"", "v3=\"-1\"").contains("a face uses vertex -1"));
    assert!(with("v3=\"3\"", "").contains("expected v1, v2 and v3"));
    assert!(with("</mesh>", "").starts_with("3D/3dmodel.model, byte "));
    let item = |item: &str| refused(&model(&object(1, TETRAHEDRON), item));
    assert!(item("<item objectid=\"2\"/>").contains("found object 2, expected the id of an object"));
    assert!(item("<item objectid=\"-2\"/>").contains("expected objectid"));
    assert!(item("<item objectid=\"1\" transform=\"1 0 0\"/>").contains("twelve finite numbers"));
    assert!(
        item("<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 0 0 0 0\"/>").contains("does not flatten")
    );
    assert!(
        item("<item objectid=\"1\" transform=\"1e38 0 0 0 1e38 0 0 0 1 1e39 0 0\"/>")
            .contains("x coordinate is inf")
    );
    let twice = object(1, TETRAHEDRON) + &object(1, TETRAHEDRON);
    assert!(refused(&model(&twice, "")).contains("a second object 1"));
    assert!(refused(&model("", "")).contains("no triangles in this 3MF file"));
    let beams = package("xmlns:b=\"urn:beams\" requiredextensions=\"b\"", &model("", ""));
    assert!(complaint(&beams, Format::ThreeMf).contains("\"urn:beams\""));
    assert!(
        complaint(&zipped(&[("readme.txt", b"hello")]), Format::ThreeMf).contains("no part 3D/3dmodel.model")
    );
    assert!(complaint(b"not a zip", Format::ThreeMf).contains("no zip package"));
}

#[test]
fn document_types_and_endless_nesting_are_refused() {
    let entity = "<!DOCTYPE model [<!ENTITY a \"&a;&a;\">]><model/>";
    assert!(
        complaint(&zipped(&[("3D/3dmodel.model", entity.as_bytes())]), Format::ThreeMf)
            .contains("a document type")
    );
    assert!(refused(&"<a>".repeat(100_000)).contains("XML elements inside each other"));
}

#[test]
fn circles_and_copies_of_copies_are_refused_at_once() {
    let begun = Instant::now();
    let pair = |of: u32| {
        format!("<components><component objectid=\"{of}\"/><component objectid=\"{of}\"/></components>")
    };
    let circle = object(1, &pair(2)) + &object(2, &pair(1));
    assert!(refused(&model(&circle, "<item objectid=\"1\"/>")).contains("inside itself"));

    let doubled = |first: &str| {
        let mut resources = object(1, first);
        for id in 2..=60 {
            resources += &object(id, &pair(id - 1));
        }
        package("", &model(&resources, "<item objectid=\"60\"/>"))
    };
    assert!(matches!(load(&doubled(TETRAHEDRON), Format::ThreeMf), Err(ReadError::TooLarge { .. })));
    assert!(matches!(load(&doubled("<mesh/>"), Format::ThreeMf), Err(ReadError::NoTriangles { .. })));

    let mut deep = object(1, TETRAHEDRON);
    for id in 2..=10_000 {
        deep += &object(id, &format!("<components><component objectid=\"{}\"/></components>", id - 1));
    }
    let deep = model(&deep, "<item objectid=\"10000\"/>");
    assert!(refused(&deep).contains("components inside each other"));
    assert!(begun.elapsed() < Duration::from_secs(2), "took {:?}", begun.elapsed());
}

#[test]
fn a_zip_bomb_is_refused_in_a_moment() {
    let begun = Instant::now();
    let mut text = String::from("<model><metadata name=\"a\">");
    text += &" ".repeat(200 << 20);
    let bytes = zipped(&[("3D/3dmodel.model", text.as_bytes())]);
    let packed = begun.elapsed();
    assert!(bytes.len() < 1 << 20, "{} bytes", bytes.len());
    assert!(matches!(load(&bytes, Format::ThreeMf), Err(ReadError::TooLarge { .. })));
    assert!(begun.elapsed() - packed < Duration::from_secs(2), "took {:?}", begun.elapsed() - packed);
}

#[test]
fn an_index_that_announces_more_parts_than_memory_is_refused() {
    let mut bytes = zipped(&[("3D/3dmodel.model", b"<model/>")]);
    let end = bytes.len() - 22;
    let mut index64 = b"PK\x06\x06".to_vec();
    index64.extend(44u64.to_le_bytes());
    index64.extend([45, 0, 45, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    index64.extend((1u64 << 40).to_le_bytes());
    index64.extend((1u64 << 40).to_le_bytes());
    index64.extend([0; 16]);
    index64.extend(b"PK\x06\x07\0\0\0\0");
    index64.extend((end as u64).to_le_bytes());
    index64.extend([1, 0, 0, 0]);
    bytes.splice(end..end, index64);
    assert!(complaint(&bytes, Format::ThreeMf).contains("parts in the package"));
}
