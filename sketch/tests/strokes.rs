//! Strokes from pens and from files: cleaned, edited, placed, and never a panic.

use glam::Vec2;
use sketch::stroke::{
    DoodleChoice, FileFormat, MAX_DRAWN_POINTS, MAX_STROKES, OrientedBox, PenSample, Placement, ReadError,
    ReadProblem, Sketch, Standing, Stroke, clean, detect, read, resample, write_strokes,
};
use std::f32::consts::TAU;
use std::path::Path;

fn strokes_of(text: &str, format: FileFormat) -> Result<Vec<Stroke>, ReadError> {
    read(text.as_bytes(), format, &DoodleChoice::default())
}

fn json(text: &str) -> Result<Vec<Stroke>, ReadError> {
    strokes_of(text, FileFormat::Strokes)
}

fn svg(body: &str) -> Result<Vec<Stroke>, ReadError> {
    let open = r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink""#;
    strokes_of(&format!("{open} width=\"200\" height=\"100\">{body}</svg>"), FileFormat::Svg)
}

fn places(stroke: &Stroke) -> Vec<Vec2> {
    stroke.places().collect()
}

fn arc(count: usize) -> Stroke {
    Stroke::through((0..count).map(|i| 300.0 + 100.0 * Vec2::from_angle(i as f32 / count as f32)))
}

#[test]
fn cleaning_leaves_finite_samples_in_their_ranges_and_the_order_of_time() {
    let odd = |x: f32, time, pressure| PenSample { x, y: 1.5, time, pressure, tilt: [f32::NAN, 200.0] };
    let stroke = Stroke {
        samples: vec![
            odd(f32::NAN, Some(0.0), 0.5),
            odd(1.5, Some(1.0), 7.0),
            odd(1.5, Some(1.1), 0.2),
            odd(f32::INFINITY, None, 0.5),
            odd(2.5, Some(0.5), f32::NAN),
            odd(3.5, Some(f32::NAN), -1.0),
            odd(1e9, None, 0.5),
        ],
        eraser: true,
    };
    let cleaned = clean(&stroke);
    assert!(cleaned.eraser);
    let x: Vec<f32> = cleaned.samples.iter().map(|sample| sample.x).collect();
    assert_eq!(x, [1.5, 2.5, 3.5]);
    let known: Vec<_> = cleaned.samples.iter().map(|sample| (sample.time, sample.pressure)).collect();
    assert_eq!(known, [(Some(1.0), 1.0), (Some(1.0), 1.0), (None, 0.0)]);
    assert!(cleaned.samples.iter().all(|sample| sample.tilt == [0.0, 90.0]));
}

#[test]
fn cleaning_twice_is_cleaning_once_for_strokes_without_stairs() {
    for seed in 0..50 {
        let mut random = fastrand::Rng::with_seed(seed);
        let stroke = Stroke::through((0..random.usize(0..60)).map(|_| {
            let odd = random.usize(0..12) == 0;
            if odd { Vec2::NAN } else { Vec2::new(random.f32(), random.f32()) * 500.0 }
        }));
        let once = clean(&stroke);
        assert_eq!(clean(&once), once, "seed {seed}");
    }
}

#[test]
fn a_lone_jump_of_the_device_goes_and_a_drawn_spike_stays() {
    let mut jumped = arc(200);
    jumped.samples[77].x += 250.0;
    assert_eq!(clean(&jumped).samples.len(), 199);
    let star = Stroke::through((0..=20).map(|i| {
        let radius = if i % 2 == 0 { 100.0 } else { 12.0 };
        300.5 + radius * Vec2::from_angle(TAU * i as f32 / 20.0)
    }));
    assert_eq!(clean(&star), star, "a star of few points keeps them all");
}

#[test]
fn stairs_of_whole_pixels_become_a_line_within_half_a_pixel_of_them() {
    let at = |i: f32| Vec2::new(i, 0.3 * i);
    let line: Vec<Vec2> = (0..200).map(|i| at(i as f32)).collect();
    let rounded = Stroke::through(line.iter().map(|p| p.round()));
    let smooth = clean(&rounded);
    let error = |stroke: &Stroke| {
        let off = stroke.places().map(|p| (p.y - 0.3 * p.x).powi(2)).sum::<f32>();
        (off / stroke.samples.len() as f32).sqrt()
    };
    assert!(error(&smooth) < 0.6 * error(&rounded), "{} of {}", error(&smooth), error(&rounded));
    let moved = smooth.places().zip(rounded.places()).map(|(a, b)| (a - b).abs().max_element());
    assert!(moved.fold(0.0, f32::max) <= 0.5);
}

#[test]
fn resampling_keeps_the_ends_the_length_and_the_even_distances() {
    let stroke = Stroke {
        samples: arc(57)
            .samples
            .iter()
            .enumerate()
            .map(|(i, s)| PenSample { time: Some(i as f32), ..*s })
            .collect(),
        eraser: false,
    };
    for spacing in [0.3, 1.0, 7.0, 1e6, 0.0, f32::NAN, -1.0] {
        let even = resample(&stroke, spacing);
        assert_eq!((even.samples[0], even.samples.last()), (stroke.samples[0], stroke.samples.last()));
        assert!(even.length() <= stroke.length() * 1.0001, "{spacing}");
        let steps: Vec<f32> = even.samples.windows(2).map(|p| p[0].place().distance(p[1].place())).collect();
        let wanted = stroke.length() / steps.len() as f32;
        if (0.1..10.0).contains(&spacing) {
            assert!(wanted <= spacing && steps.iter().all(|step| (step - wanted).abs() < 0.05 * wanted));
            assert!(even.samples.windows(2).all(|p| p[0].time < p[1].time), "times are interpolated");
        }
    }
    assert_eq!(resample(&Stroke::default(), 1.0), Stroke::default());
}

#[test]
fn a_million_samples_are_cleaned_and_placed_at_once_and_become_few_points() {
    let start = std::time::Instant::now();
    let mut random = fastrand::Rng::with_seed(4);
    let scribble = Stroke::through((0..1_000_000).map(|_| Vec2::new(random.f32(), random.f32()) * 1000.0));
    let line = arc(1_000_000);
    for stroke in [scribble, line] {
        let sketch = Sketch::from_strokes([&stroke]);
        let drawing = Placement::of_size(&sketch, 100.0, Standing::Centred).drawing(&sketch);
        let points: usize = drawing.strokes.iter().map(|stroke| stroke.points.len()).sum();
        assert!((100..=MAX_DRAWN_POINTS + 2).contains(&points), "{points}");
    }
    assert!(start.elapsed().as_secs_f32() < 5.0, "{:?}", start.elapsed());
}

#[test]
fn a_placed_sketch_has_its_size_stands_on_the_ground_and_points_up() {
    let sketch = Sketch::from_strokes(&[Stroke::through([[100.0, 50.0], [140.0, 250.0]].map(Vec2::from))]);
    let standing = Placement::of_size(&sketch, 50.0, Standing::OnGround);
    let drawing = standing.drawing(&sketch);
    let at: Vec<Vec2> = drawing.strokes[0].points.iter().map(|point| point.at).collect();
    assert_eq!(at, [Vec2::new(-5.0, 50.0), Vec2::new(5.0, 0.0)]);
    let centred = Placement::of_size(&sketch, 50.0, Standing::Centred);
    assert_eq!(centred.mm_from_px(Vec2::new(120.0, 150.0)), Vec2::ZERO);
    let px = Vec2::new(33.0, 44.0);
    assert!(centred.px_from_mm(centred.mm_from_px(px)).distance(px) < 1e-4);
    let dot = Sketch::from_strokes(&[Stroke::through([Vec2::ONE])]);
    assert_eq!(Placement::of_size(&dot, 50.0, Standing::Centred).mm_per_px, 1.0);
    assert_eq!(Placement::of_size(&Sketch::default(), f32::NAN, Standing::OnGround).mm_per_px, 1.0);
}

#[test]
fn erasing_cuts_lines_at_the_edges_of_the_box_even_between_samples() {
    let mut sketch = Sketch::from_strokes(&[Stroke::through([Vec2::ZERO, Vec2::new(100.0, 0.0)])]);
    let area = OrientedBox { center: Vec2::new(50.0, 0.0), half: Vec2::new(10.0, 5.0), axis: Vec2::X };
    assert!(sketch.erase(&area) && !sketch.erase(&OrientedBox { half: Vec2::splat(1.0), ..area }));
    let left: Vec<Vec<Vec2>> = sketch
        .strokes
        .iter()
        .map(|stroke| stroke.samples.iter().map(|sample| sample.pen.place()).collect())
        .collect();
    assert_eq!(left.len(), 2);
    assert!(
        left[0][1].distance(Vec2::new(40.0, 0.0)) < 1e-3 && left[1][0].distance(Vec2::new(60.0, 0.0)) < 1e-3
    );
    assert!(sketch.undo_last_stroke() && !sketch.undo_last_stroke());
}

#[test]
fn the_eraser_end_of_the_pen_rubs_out_what_it_passes_over() {
    let line = Stroke::through((0..=100).map(|i| Vec2::new(i as f32 * 2.0, 50.5)));
    let eraser = Stroke { eraser: true, ..Stroke::through([Vec2::new(100.0, 0.0), Vec2::new(100.0, 100.0)]) };
    let sketch = Sketch::from_strokes(&[line.clone(), eraser.clone()]);
    assert_eq!(sketch.strokes.len(), 2);
    let gap = sketch.places().map(|p| (p.x - 100.0).abs()).fold(f32::MAX, f32::min);
    assert!((3.0..5.0).contains(&gap), "the eraser is 8 px wide here, and leaves {gap} on each side");
    assert_eq!(Sketch::from_strokes(&[eraser, line]).strokes.len(), 1, "what comes later stays");
}

#[test]
fn thousands_of_long_erasers_over_a_page_full_of_scribble_take_no_longer_than_a_few() {
    let start = std::time::Instant::now();
    let mut random = fastrand::Rng::with_seed(9);
    let mut wild = |count: usize, eraser| {
        let places = (0..count).map(|_| Vec2::new(random.f32(), random.f32()) * 1000.0);
        Stroke { eraser, ..Stroke::through(places) }
    };
    let strokes: Vec<Stroke> = (0..MAX_STROKES).map(|i| wild(20, i % 2 == 1)).collect();
    let sketch = Sketch::from_strokes(&strokes);
    assert!(sketch.strokes.iter().all(|stroke| stroke.drawn > 1900), "all but the last strokes are gone");
    assert!(start.elapsed().as_secs_f32() < 10.0, "{:?}", start.elapsed());
}

#[test]
fn erasing_stroke_by_stroke_is_erasing_at_once() {
    let cross = [
        Stroke::through([[0.0, 0.0], [200.0, 100.0]].map(Vec2::from)),
        Stroke { eraser: true, ..Stroke::through([[60.0, 0.0], [60.0, 60.0]].map(Vec2::from)) },
        Stroke::through([[0.0, 100.0], [200.0, 0.0]].map(Vec2::from)),
        Stroke { eraser: true, ..Stroke::through([[150.0, 0.0], [150.0, 200.0]].map(Vec2::from)) },
    ];
    let mut one_by_one = Sketch::default();
    for stroke in &cross {
        one_by_one.add(stroke);
    }
    let at_once = Sketch::from_strokes(&cross);
    let drawn = |sketch: &Sketch| sketch.strokes.iter().map(|stroke| stroke.drawn).collect::<Vec<_>>();
    assert_eq!((drawn(&one_by_one), drawn(&at_once)), (vec![0, 0, 0, 1, 1], vec![0, 0, 0, 1, 1]));
}

#[test]
fn strokes_survive_being_written_and_read() {
    for seed in 0..20 {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut sample = || PenSample {
            x: random.f32() * 1000.0,
            y: random.f32() * -1000.0,
            time: random.bool().then(|| random.f32()),
            pressure: random.f32(),
            tilt: [random.f32() * 90.0, -random.f32()],
        };
        let strokes: Vec<Stroke> = (0..3)
            .map(|i| Stroke { samples: (0..i * 5).map(|_| sample()).collect(), eraser: i == 1 })
            .collect();
        let text = write_strokes(&strokes);
        assert_eq!(detect(text.as_bytes(), None), Ok(FileFormat::Strokes));
        assert_eq!(json(&text).as_ref(), Ok(&strokes), "seed {seed}");
    }
}

#[test]
fn short_samples_mean_what_long_ones_do() {
    let text = r#"{"format":"trullo-strokes","version":1,"strokes":[{"samples":
        [[1,2],[1,2,3],[1,2,3,0.5],{"x":1,"y":2,"tilt":[4,5]}]}]}"#;
    let samples = &json(text).expect("legal")[0].samples;
    let known: Vec<_> = samples.iter().map(|s| (s.x, s.y, s.time, s.pressure, s.tilt)).collect();
    assert_eq!(known[0], (1.0, 2.0, None, 1.0, [0.0; 2]));
    assert_eq!(known[1], (1.0, 2.0, Some(3.0), 1.0, [0.0; 2]));
    assert_eq!(known[2], (1.0, 2.0, Some(3.0), 0.5, [0.0; 2]));
    assert_eq!(known[3], (1.0, 2.0, None, 1.0, [4.0, 5.0]));
}

#[test]
fn broken_strokes_are_refused_with_line_column_and_reason() {
    let refused = |text: &str| json(text).expect_err(text).to_string();
    let head = "{\"format\": \"trullo-strokes\", \"version\": 1,\n";
    for (text, says) in [
        (
            format!("{head}\"strokes\": [{{\"samples\": [], \"color\": 1}}]}}"),
            "line 2, column 35: unknown field `color`",
        ),
        (
            format!("{head}\"strokes\": [{{\"samples\": [[1]]}}]}}"),
            "line 2, column 28: invalid length 1, expected a sample",
        ),
        (format!("{head}\"strokes\": [{{\"samples\": [{{\"x\": 1}}]}}]}}"), "missing field `y`"),
        (format!("{head}\"strokes\": [{{\"samples\": [[1, \"a\"]]}}]}}"), "expected f32"),
        (format!("{head}\"strokes\": [{{"), "EOF"),
        (format!("{head}\"strokes\": []}} x"), "line 2, column 16: trailing characters"),
        (head.replace("1,", "9, \"x\": 1}"), "version 9 of the strokes format"),
        (head.replace("trullo-strokes", "dxf").replace(",\n", "}"), "`format` is \"dxf\""),
        ("{}".into(), "`format` is missing"),
        ("[1, 2]".into(), "`format` is missing"),
        (" \n".into(), "the file is empty"),
    ] {
        assert!(refused(&text).contains(says), "{text}: {}", refused(&text));
    }
    assert_eq!(
        read(b"{\n \xff", FileFormat::Strokes, &DoodleChoice::default()).expect_err("bytes").to_string(),
        "line 2, column 2: not text in UTF-8"
    );
}

#[test]
fn files_are_told_apart_by_what_is_in_them_before_their_names() {
    let told = |text: &str, name: &str| detect(text.as_bytes(), Some(Path::new(name))).ok();
    assert_eq!(told("\u{feff}\n <svg/>", "a.json"), Some(FileFormat::Svg));
    assert_eq!(told(r#"{"word": "cat", "drawing": []}"#, "a.json"), Some(FileFormat::Doodles));
    assert_eq!(told(r#"{"format": "trullo-strokes"}"#, "a.ndjson"), Some(FileFormat::Strokes));
    assert_eq!(told("", "a.SVG"), Some(FileFormat::Svg));
    assert_eq!(told("solid cube", "a.stl"), None);
    assert_eq!(told("", "a"), None);
    let scene = detect(br#"{"format": "trullo", "version": 1}"#, None).expect_err("a scene");
    assert_eq!(scene.problem, ReadProblem::Scene);
}

#[test]
fn doodles_are_chosen_by_line_or_key() {
    let text = "{\"word\":\"a\",\"key_id\":\"77\",\"drawing\":[[[1,2],[3,4]]]}\n\n\
                {\"word\":\"b\",\"key_id\":\"78\",\"drawing\":[[[5],[6]],[[7,8],[9,9],[0,500]]]}\n";
    let by = |choice| read(text.as_bytes(), FileFormat::Doodles, &choice);
    assert_eq!(
        places(&by(DoodleChoice::Index(0)).expect("there")[0]),
        [Vec2::new(1.0, 3.0), Vec2::new(2.0, 4.0)]
    );
    let second = by(DoodleChoice::Key("78".into())).expect("there");
    assert_eq!(by(DoodleChoice::Index(1)).as_ref(), Ok(&second));
    assert_eq!(second[1].samples[1].time, Some(0.5), "milliseconds");
    assert_eq!(by(DoodleChoice::Index(2)).expect_err("not there").problem, ReadProblem::NoSuchDoodle(2, 2));
    assert!(matches!(
        by(DoodleChoice::Key("7".into())),
        Err(ReadError { problem: ReadProblem::NoSuchKey(_), .. })
    ));
    let refused =
        |line: &str| strokes_of(&format!("\n{line}"), FileFormat::Doodles).expect_err(line).to_string();
    assert!(
        refused(r#"{"drawing": [[[1, 2], [3]]]}"#).starts_with("line 2, column 1: stroke 0 of the doodle")
    );
    assert!(refused(r#"{"drawing": [[[1, 2]]]}"#).contains("1 lists"));
    assert!(refused(r#"{"drawing": 3}"#).starts_with("line 2, column 13: invalid type"));
}

#[test]
fn shapes_groups_transforms_and_reused_parts_of_an_svg_become_strokes() {
    let strokes = svg(
        r##"<g transform="translate(10 20) scale(2)"><rect width="30" height="20"/>
            <g id="leg"><path d="m1 1 h5 v5" fill="none" stroke="red"/></g></g>
            <use xlink:href="#leg" x="50"/><polygon points="0,0 10,0 0,10"/>
            <polyline points="0,0 10,0 0,10" fill="none" stroke="black"/><line x2="9" y2="9" stroke="red"/>"##,
    )
    .expect("legal");
    let all: Vec<Vec<Vec2>> = strokes.iter().map(places).collect();
    assert_eq!(all.len(), 6);
    let corners = |list: &[[f32; 2]]| list.iter().copied().map(Vec2::from).collect::<Vec<_>>();
    assert_eq!(all[0], corners(&[[10., 20.], [70., 20.], [70., 60.], [10., 60.], [10., 20.]]));
    assert_eq!(all[1], corners(&[[12., 22.], [22., 22.], [22., 32.]]));
    assert_eq!(all[2], corners(&[[51., 1.], [56., 1.], [56., 6.]]));
    assert_eq!(all[3], corners(&[[0., 0.], [10., 0.], [0., 10.], [0., 0.]]), "polygons are closed");
    assert_eq!(all[4], corners(&[[0., 0.], [10., 0.], [0., 10.]]), "lines are not");
    assert_eq!(all[5], corners(&[[0., 0.], [9., 9.]]));
}

#[test]
fn curves_of_an_svg_are_left_by_less_than_a_four_thousandth_of_the_picture() {
    let round = &svg(r#"<circle cx="100" cy="50" r="40"/>"#).expect("legal")[0];
    let middle = Vec2::new(100.0, 50.0);
    assert!(round.samples.len() < 500, "{}", round.samples.len());
    for pair in round.samples.windows(2) {
        for t in [0.0, 0.25, 0.5] {
            let off = (pair[0].place().lerp(pair[1].place(), t).distance(middle) - 40.0).abs();
            // The cubics of a drawn circle are themselves off by 0.03 %.
            assert!(off < 80.0 / 4000.0 + 40.0 * 3e-4, "{off}");
        }
    }
    let bend = &svg(r#"<path d="M0 0 Q 50 100 100 0" fill="none" stroke="red"/>"#).expect("legal")[0];
    assert!(bend.places().all(|p| (p.y - 2.0 * p.x * (1.0 - p.x / 100.0)).abs() < 1e-3));
}

#[test]
fn svgs_without_outlines_or_with_too_many_say_so() {
    let says = |body: &str| svg(body).expect_err(body).to_string();
    assert!(says("<text>abc</text>").contains("text must be converted to paths"));
    assert!(says("").contains("no outlines"));
    let many = "<path d='M0 0h9v9z'/>".repeat(MAX_STROKES + 1);
    assert!(says(&many).contains("more than 4096"));
    let contours = format!("<path d='{}'/>", "M0 0h9v9z".repeat(50_000));
    assert!(says(&contours).contains("more than 4096"));
    assert!(says("<g>").starts_with("line 1, column "), "{}", says("<g>"));
    assert!(says(&format!("{}{}", "<g>".repeat(5000), "</g>".repeat(5000))).contains("deep"));
    assert!(strokes_of("<html/>", FileFormat::Svg).is_err());
}

#[test]
fn svgs_built_to_exhaust_the_reader_are_refused_or_stay_small() {
    let mut laughs = String::from("<g id='a0'><path d='M0 0h9v9z'/></g>");
    for i in 1..12 {
        let uses = format!("<use xlink:href='#a{}'/>", i - 1).repeat(10);
        laughs += &format!("<g id='a{i}'>{uses}</g>");
    }
    assert!(svg(&laughs).expect_err("a trillion shapes").to_string().contains("reused parts make more than"));
    let circle = "<g id='a'><use xlink:href='#b'/></g><g id='b'><use xlink:href='#a'/></g>";
    assert!(svg(circle).is_err());
    let entities = "<!DOCTYPE svg [<!ENTITY a '&b;&b;'><!ENTITY b '&a;&a;'>]>\
                    <svg xmlns='http://www.w3.org/2000/svg'>&a;</svg>";
    assert!(strokes_of(entities, FileFormat::Svg).is_err());
    let chained =
        [("clipPath", "clip-path"), ("pattern", "fill"), ("mask", "mask"), ("marker", "marker-mid")];
    for (kind, link) in chained {
        // Each part points twice to the one before, so that following them would take 2^2000 steps.
        let mut chain = String::from("<path d='M0 0h9v9z'/>");
        for i in 1..=2000 {
            let path = format!("<path d='M0 0h9v9z' {link}='url(#a{})'/>", i - 1);
            chain += &format!("<{kind} id='a{i}' width='1' height='1'>{path}{path}</{kind}>");
        }
        chain += &format!("<path d='M0 0h9v9z' {link}='url(#a2000)'/>");
        assert_eq!(svg(&chain).map(|strokes| strokes.len()), Ok(2), "{kind}");
    }
    let hidden = "<path d='M0 0h9v9z' mask='&#117;rl(#a)'/>";
    assert!(svg(hidden).expect_err("hidden").to_string().contains("character references"));
    let rules: String = (0..20_000).map(|i| format!(".c{i} .d > rect:first-child{{fill:red}}")).collect();
    let styled = format!("<style>{rules}</style>{}", "<rect width='1' height='1'/>".repeat(3000));
    assert!(svg(&styled).expect_err("styles").to_string().contains("too many"));
    let outside = r#"<image width="9" height="9" xlink:href="/etc/passwd"/><path d="M0 0h9v9z"/>"#;
    assert_eq!(svg(outside).map(|strokes| strokes.len()), Ok(1));
    let huge = r#"<path d="M0 0 C1e38 -1e38 1e38 1e38 9 9zM1 1h1e30v-1e38z"/>"#;
    let _ = svg(huge);
}

/// One good file of each kind.
fn good_files() -> [(FileFormat, String); 3] {
    let mut strokes = vec![arc(12), Stroke { eraser: true, ..arc(5) }];
    strokes[0].samples[3].time = Some(0.5);
    let doodle =
        "{\"word\":\"a\",\"key_id\":\"77\",\"drawing\":[[[1,2],[3,4]],[[5,6,7],[8,9,10]]]}\n".repeat(3);
    let picture = r#"<?xml version="1.0"?><!-- a house --><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">
        <defs><path id="p" d="M0 0 C 1 2 3 4 5 6 S 7 8 9 0 Q 1 1 2 2 T 3 3 A 2 3 45 1 0 4 4 z"/></defs>
        <style>rect { fill: red }</style><g transform="rotate(30 1 2) skewX(5)" opacity="0.5"><rect x="1"
        y="1" width="5" height="4" rx="1"/><ellipse cx="4" cy="4" rx="3" ry="2"/></g></svg>"#;
    [
        (FileFormat::Strokes, write_strokes(&strokes)),
        (FileFormat::Svg, picture.into()),
        (FileFormat::Doodles, doodle),
    ]
}

/// Reads it as what it is taken for and as everything else; only returning matters.
fn survive(bytes: &[u8]) {
    let _ = detect(bytes, None);
    for format in [FileFormat::Strokes, FileFormat::Svg, FileFormat::Doodles] {
        for choice in [DoodleChoice::Index(1), DoodleChoice::Key("77".into())] {
            if let Ok(strokes) = read(bytes, format, &choice) {
                let sketch = Sketch::from_strokes(&strokes);
                let _ = Placement::of_size(&sketch, 80.0, Standing::OnGround).drawing(&sketch);
            }
        }
    }
}

#[test]
fn files_cut_off_anywhere_are_errors_with_a_reason_and_no_panic() {
    for (format, text) in good_files() {
        assert!(read(text.as_bytes(), format, &DoodleChoice::Index(1)).is_ok());
        for percent in 0..100 {
            let cut = &text.as_bytes()[..text.len() * percent / 100];
            survive(cut);
            let result = read(cut, format, &DoodleChoice::Index(2));
            assert!(result.is_err(), "{format:?} cut off at {percent} % is read");
        }
    }
}

#[test]
fn files_with_flipped_bits_and_swapped_pieces_never_panic() {
    for (_, text) in good_files() {
        for seed in 0..400 {
            let mut random = fastrand::Rng::with_seed(seed);
            let mut bytes = text.clone().into_bytes();
            for _ in 0..random.usize(1..6) {
                let at = random.usize(0..bytes.len());
                match random.usize(0..4) {
                    0 => bytes[at] ^= 1 << random.u32(0..8),
                    1 => bytes[at] = b"0123456789eE+-.,[]{}\"<>/&;"[random.usize(0..26)],
                    2 => {
                        bytes.remove(at);
                    }
                    _ => {
                        let piece = bytes[at..(at + random.usize(0..9)).min(bytes.len())].to_vec();
                        let to = random.usize(0..bytes.len());
                        bytes.splice(to..to, piece);
                    }
                }
            }
            survive(&bytes);
        }
    }
}

#[test]
fn numbers_and_lists_beyond_all_measure_are_refused_or_cleaned_away() {
    let head = r#"{"format":"trullo-strokes","version":1,"strokes":"#;
    let big = format!("{head}[{{\"samples\":[[1e39,1],[1,1e300],[3,4]]}}]}}");
    if let Ok(strokes) = json(&big) {
        assert_eq!(clean(&strokes[0]).samples.len(), 1);
    }
    assert!(json(&format!("{head}[{{\"samples\":[[1e999,1]]}}]}}")).is_err());
    let many = format!("{head}[{}{{\"samples\":[]}}]}}", "{\"samples\":[]},".repeat(MAX_STROKES));
    assert!(json(&many).expect_err("too many").to_string().contains("more than 4096 strokes"));
    let deep = format!("{head}{}", "[".repeat(200_000));
    assert!(json(&deep).is_err());
    survive(deep.as_bytes());
    let doodle = format!("{{\"drawing\":[{}[[1],[1]]]}}", "[[1],[1]],".repeat(MAX_STROKES));
    let error = strokes_of(&doodle, FileFormat::Doodles).expect_err("too many");
    assert_eq!(error.problem, ReadProblem::TooManyStrokes(MAX_STROKES + 1));
    let long = vec![b' '; (64 << 20) + 1];
    let error = read(&long, FileFormat::Svg, &DoodleChoice::default()).expect_err("too large");
    assert_eq!(error.problem, ReadProblem::TooLarge);
}
