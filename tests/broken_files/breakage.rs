//! Broken files, made from small good ones.

use crate::common::Folder;
use glam::Vec3;
use mesh::io::{Attachments, Format, write};
use mesh::shapes::ico_sphere;
use std::io::Cursor;

/// A broken file in the folder.
pub struct Broken {
    /// Its name.
    pub name: String,
    /// Whether it may be a whole file all the same, such as half an OBJ file.
    pub may_be_legal: bool,
}

/// A scene with nested nodes, a shared part, and two words for every kind of value.
const SCENE: &str = r##"{"format": "trullo", "version": 1, "title": "Two balls", "define": {
    "ball": {"type": "point", "name": "ball", "center": [0, 0, 10], "radius": 10, "falloff": 4}
}, "root": {"type": "blend", "sharpness": 2.5, "children": [
    {"use": "ball"},
    {"type": "transform", "translate": [0, 0, 14], "scale": [0.5, 0.5, 0.5], "child": {"use": "ball"}},
    {"type": "box", "muted": false, "color": "#ff8000", "center": [9, 0, 4], "size": [6, 4, 8], "rounding": 1}
]}}"##;

struct Workshop<'a> {
    folder: &'a Folder,
    files: Vec<Broken>,
}

/// Makes them all.
pub fn all(folder: &Folder) -> Vec<Broken> {
    let mut shop = Workshop { folder, files: Vec::new() };
    let meshes = good_meshes();
    cut_off(&mut shop, &meshes);
    flipped(&mut shop, &meshes);
    wrong_scenes(&mut shop);
    oversized_scenes(&mut shop);
    wrong_meshes(&mut shop, &meshes);
    no_files(&mut shop);
    shop.files
}

/// A ball in each format, by extension.
fn good_meshes() -> Vec<(&'static str, Vec<u8>)> {
    let ball = ico_sphere(Vec3::new(0.0, 0.0, 10.0), 10.0, 2);
    let scene = Attachments { scene: Some(SCENE.into()), ..Attachments::default() };
    let formats = [Format::Stl, Format::StlAscii, Format::Obj, Format::Ply, Format::ThreeMf];
    let written = formats.map(|format| {
        let mut file = Cursor::new(Vec::new());
        write(&mut file, &ball, format, &scene).expect("a ball is writable");
        (format.extension(), file.into_inner())
    });
    written.into()
}

impl Workshop<'_> {
    fn add(&mut self, name: String, bytes: impl AsRef<[u8]>, may_be_legal: bool) {
        self.folder.write(&name, bytes);
        self.register(name, may_be_legal);
    }

    fn register(&mut self, name: String, may_be_legal: bool) {
        self.files.push(Broken { name, may_be_legal });
    }

    fn scene(&mut self, name: &str, text: &str) {
        self.add(format!("{name}.trullo"), text, false);
    }

    /// A scene with this root.
    fn root(&mut self, name: &str, root: &str) {
        self.scene(name, &format!(r#"{{"format": "trullo", "version": 1, "root": {root}}}"#));
    }
}

/// Scenes at every percent of their length, the mesh formats in turn.
fn cut_off(shop: &mut Workshop, meshes: &[(&str, Vec<u8>)]) {
    for percent in 0..100 {
        let cut = |bytes: &[u8]| bytes[..bytes.len() * percent / 100].to_vec();
        shop.add(format!("cut-{percent}.trullo"), cut(SCENE.as_bytes()), false);
        let (extension, bytes) = &meshes[percent % meshes.len()];
        let is_text = percent % meshes.len() == 1 || *extension == "obj";
        shop.add(format!("cut-{percent}.{extension}"), cut(bytes), is_text);
    }
}

/// One bit changed, at places spread over the whole file; most of what the file holds may be another number.
fn flipped(shop: &mut Workshop, meshes: &[(&str, Vec<u8>)]) {
    for turn in 0..10 {
        let mut flip = |number: usize, extension: &str, bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            let at = bytes.len() * (2 * turn + 1) / 20;
            bytes[at] ^= 1 << ((turn + 3 * number) % 8);
            shop.add(format!("flip-{turn}-{number}.{extension}"), bytes, true);
        };
        flip(0, "trullo", SCENE.as_bytes());
        flip(1, "trullo", SCENE.as_bytes());
        for (number, (extension, bytes)) in meshes.iter().enumerate() {
            flip(number, extension, bytes);
        }
    }
}

fn wrong_scenes(shop: &mut Workshop) {
    let replacements = [
        ("not-ours", r#""trullo""#, r#""step""#),
        ("newer", r#""version": 1"#, r#""version": 2"#),
        ("no-version", r#""version": 1, "#, ""),
        ("text-for-number", r#""radius": 10"#, r#""radius": "10""#),
        ("list-for-number", r#""radius": 10"#, r#""radius": [10]"#),
        ("number-for-list", r#""center": [0, 0, 10]"#, r#""center": 10"#),
        ("two-coordinates", "[0, 0, 10]", "[0, 10]"),
        ("null", r#""radius": 10"#, r#""radius": null"#),
        ("nan", r#""radius": 10"#, r#""radius": NaN"#),
        ("huge-number", r#""radius": 10"#, r#""radius": 1e999"#),
        ("negative", r#""radius": 10"#, r#""radius": -10"#),
        ("zero-scale", "[0.5, 0.5, 0.5]", "[0, 0.5, 0.5]"),
        ("unknown-field", r#""rounding""#, r#""roundness""#),
        ("unknown-type", r#""type": "box""#, r#""type": "boks""#),
        ("twice", r#""rounding": 1"#, r#""rounding": 1, "rounding": 1"#),
        ("no-such-part", r#"{"use": "ball"}"#, r#"{"use": "bell"}"#),
        ("bad-colour", "#ff8000", "orange"),
        ("cycle", r#"{"type": "point", "name": "ball","#, r#"{"use": "ball", "name": "ball","#),
        ("children-by-name", r#""children": ["#, r#""children": {"a": ["#),
        ("comment", r#""root""#, r#"/* the tree */ "root""#),
    ];
    for (name, from, to) in replacements {
        assert!(SCENE.contains(from), "{name} changes nothing");
        shop.scene(name, &SCENE.replacen(from, to, 1));
    }
    shop.scene(
        "circle",
        r#"{"format": "trullo", "version": 1, "define": {
        "a": {"type": "union", "children": [{"use": "b"}]}, "b": {"type": "union", "children": [{"use": "a"}]}
    }, "root": {"use": "a"}}"#,
    );
    shop.root(
        "no-mesh-there",
        &format!(r#"{{"type": "mesh", "file": "none.stl", "sha256": "{}"}}"#, "0".repeat(64)),
    );
    shop.scene("a-list", "[1, 2, 3]");
    shop.scene("after-the-end", &format!("{SCENE}{SCENE}"));
    shop.add("not-utf-8.trullo".into(), b"{\"format\": \"trullo\", \"title\": \"\xff\xfe\"}", false);
    shop.add(
        "utf-16.trullo".into(),
        SCENE.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>(),
        false,
    );
}

fn oversized_scenes(shop: &mut Workshop) {
    shop.scene("brackets", &"[".repeat(10_000));
    shop.scene("million-brackets", &"{\"a\":".repeat(1_000_000));
    let open = r#"{"type": "union", "children": ["#.repeat(10_000);
    shop.root("nested", &format!("{open}{}", "]}".repeat(10_000)));
    let warped = r#"{"type": "transform", "child": "#.repeat(10_000);
    shop.root("warped", &format!("{warped}{}{}", r#"{"type": "sum", "children": []}"#, "}".repeat(10_000)));
    let point = r#"{"type":"point","center":[0,0,1],"radius":1}"#;
    let million = vec![point; 1_000_000].join(",");
    shop.root("million-nodes", &format!(r#"{{"type": "union", "children": [{million}]}}"#));
    let doubled: Vec<String> = (1..40)
        .map(|i| {
            format!(r#""{i}": {{"type": "sum", "children": [{{"use": "{0}"}}, {{"use": "{0}"}}]}}"#, i - 1)
        })
        .collect();
    let defined = format!(r#""0": {point}, {}"#, doubled.join(", "));
    shop.scene(
        "billion-shared-nodes",
        &format!(r#"{{"format": "trullo", "version": 1, "define": {{{defined}}}, "root": {{"use": "39"}}}}"#),
    );
    let title = "x".repeat(70_000_000);
    shop.scene("long-title", &format!(r#"{{"format": "trullo", "version": 1, "title": "{title}"}}"#));
    shop.root("long-type", &format!(r#"{{"type": "{}"}}"#, "x".repeat(1_000_000)));
    let digits = "1".repeat(1_000_000);
    shop.root("long-number", &format!(r#"{{"type": "point", "center": [0, 0, 0], "radius": {digits}}}"#));
}

fn wrong_meshes(shop: &mut Workshop, meshes: &[(&str, Vec<u8>)]) {
    let [(_, stl), (_, ascii), (_, obj), (_, ply), (_, package)] = meshes else { panic!("five formats") };
    let changed = |bytes: &[u8], at: usize, by: &[u8]| {
        let mut bytes = bytes.to_vec();
        bytes[at..at + by.len()].copy_from_slice(by);
        bytes
    };
    for count in [0, 321, 1_000_000, i32::MAX as u32, u32::MAX] {
        shop.add(format!("count-{count}.stl"), changed(stl, 80, &count.to_le_bytes()), false);
    }
    for (name, number) in [("nan", f32::NAN), ("infinite", f32::NEG_INFINITY)] {
        for at in [84 + 12, 84 + 50 * 160 + 44] {
            shop.add(format!("{name}-{at}.stl"), changed(stl, at, &number.to_le_bytes()), false);
        }
        let end_of_header = ply.windows(11).position(|w| w == b"end_header\n").expect("it has one") + 11;
        shop.add(format!("{name}.ply"), changed(ply, end_of_header, &number.to_le_bytes()), false);
    }
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("it is text");
    let (ascii, obj) = (text(ascii), text(obj));
    for (name, word) in [("nan", "NaN"), ("inf", "inf"), ("1e99", "1e99"), ("word", "x"), ("hex", "0x10")] {
        shop.add(format!("{name}.stl"), ascii.replacen("vertex ", &format!("vertex {word} "), 1), false);
        shop.add(format!("{name}.obj"), obj.replacen("v ", &format!("v {word} "), 1), false);
    }
    for (name, face) in
        [("0", "f 0 1 2"), ("big", "f 1 2 4294967297"), ("far", "f 1 2 -9999"), ("two", "f 1 2")]
    {
        shop.add(format!("face-{name}.obj"), format!("{obj}{face}\n"), false);
    }
    let header_of = |vertices: &str, faces: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nelement face {faces}\nproperty list uint int vertex_indices\nend_header\n"
        )
    };
    for (vertices, faces) in
        [("4294967295", "1"), ("3", "4294967295"), ("99999999999999999999", "1"), ("-1", "1")]
    {
        let mut bytes = header_of(vertices, faces).into_bytes();
        bytes.extend([0xff; 200]);
        shop.add(format!("counts-{vertices}-{faces}.ply"), bytes, false);
    }
    let mut polygon = header_of("1", "1").into_bytes();
    polygon.extend([[0; 4]; 3].as_flattened());
    polygon.extend([0xff; 400]);
    shop.add("huge-polygon.ply".into(), polygon, false);
    shop.add("swapped.ply".into(), text(&ply[..40]).replace("little", "medium"), false);
    shop.add("no-index.3mf".into(), &package[..package.len() - 22], false);
    shop.add("only-index.3mf".into(), &package[package.len() - 22..], false);
    for bytes in [&stl[..], &package[..]] {
        shop.add(format!("as-a-scene-{}.trullo", bytes.len()), &bytes[..bytes.len() / 2], false);
    }
    let noise: Vec<u8> = (0..20_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 11) as u8).collect();
    for extension in Format::EXTENSIONS.into_iter().chain(["trullo"]) {
        shop.add(format!("noise.{extension}"), &noise, false);
        shop.add(format!("zeros.{extension}"), [0; 5000], false);
    }
}

/// Nothing inside, folders, links to nowhere, and files that may not be opened.
fn no_files(shop: &mut Workshop) {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let made = "the folder is ours";
    for extension in Format::EXTENSIONS.into_iter().chain(["trullo"]) {
        shop.add(format!("empty.{extension}"), [], false);
        shop.register(format!("missing.{extension}"), false);
        std::fs::create_dir(shop.folder.path(&format!("folder.{extension}"))).expect(made);
        shop.register(format!("folder.{extension}"), false);
        let name = format!("circle.{extension}");
        symlink(&name, shop.folder.path(&format!("link-{name}"))).expect(made);
        symlink(format!("link-{name}"), shop.folder.path(&format!("linked-{name}"))).expect(made);
        shop.register(format!("linked-{name}"), false);
        let name = format!("locked.{extension}");
        shop.add(name.clone(), SCENE, false);
        let path = shop.folder.path(&name);
        std::fs::set_permissions(&path, PermissionsExt::from_mode(0o000)).expect(made);
        // Root may read everything.
        shop.files.last_mut().expect("it was just added").may_be_legal = std::fs::read(&path).is_ok();
    }
}
