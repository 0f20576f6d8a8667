mod common;
use common::*;
use glam::Vec3;
use polygonizer::*;
#[test]
fn dbg() {
    let seed: u64 = std::env::var("SEED").unwrap_or("8".into()).parse().unwrap();
    let mut random = Random(seed);
    let turned = TurnedBox {
        center: random.point(5.0),
        turn: random.turn(),
        half: Vec3::new(random.between(3.0, 8.0), random.between(3.0, 8.0), random.between(3.0, 8.0)),
    };
    let cells = if seed % 2 == 0 { 20 } else { 40 };
    let solid = turned.as_planes();
    let size = CellSize::across(solid.bounds.size().max_element(), cells).unwrap();
    let h = size.mm();
    let s = Surface::build(&solid, size, &Options::default()).unwrap();
    let mesh = s.mesh();
    let kinds = s.kinds();
    let mut bad = 0; let mut n = 0; let mut shown = 0;
    for [a, b] in turned.edges() {
        for i in 0..60 {
            let p = a.lerp(b, i as f32 / 59.0);
            let d = distance_to_mesh(p, &mesh) / h;
            n += 1;
            if d > 0.05 { bad += 1;
              if shown < 4 {
                shown += 1;
                println!("point {} off {d} cell {:?}", p / h, (p/h).floor());
                let mut near: Vec<usize> = (0..mesh.positions.len()).filter(|&i| mesh.positions[i].distance(p) < 1.3*h).collect();
                near.sort_by(|&x,&y| mesh.positions[x].distance(p).total_cmp(&mesh.positions[y].distance(p)));
                for i in near { let v = mesh.positions[i]; println!("   v{i} {:?} at {} dist {} sd {}", kinds[i], v/h, v.distance(p)/h, (solid.distance)(v).0/h); }
                for sx in 0..2 { for sy in 0..2 { for sz in 0..2 {
                    let c = ((p/h).floor() + Vec3::new(sx as f32, sy as f32, sz as f32)) * h;
                    print!("  {}{}{}:{:.2}", sx,sy,sz,(solid.distance)(c).0/h);
                }}} println!();
              }
            }
        }
    }
    for p in turned.corners() {
        let d = mesh.positions.iter().map(|v| v.distance(p)).fold(9e9, f32::min) / h;
        if d > 0.05 {
              println!("CORNER {} off {d} cell {:?}", p / h, (p/h).floor());
                let mut near: Vec<usize> = (0..mesh.positions.len()).filter(|&i| mesh.positions[i].distance(p) < 1.3*h).collect();
                near.sort_by(|&x,&y| mesh.positions[x].distance(p).total_cmp(&mesh.positions[y].distance(p)));
                for i in near { let v = mesh.positions[i]; println!("   v{i} {:?} at {} dist {} sd {}", kinds[i], v/h, v.distance(p)/h, (solid.distance)(v).0/h); }
                for sx in -1..3 { for sy in -1..3 { for sz in -1..3 {
                    let c = ((p/h).floor() + Vec3::new(sx as f32, sy as f32, sz as f32)) * h;
                    print!("{}", if (solid.distance)(c).0 <= 0.0 {'#'} else {'.'});
                } print!(" "); } println!(); } println!();
        }
    }
    println!("bad {bad} of {n}");
    let c = |k| kinds.iter().filter(|&&x| x == k).count();
    println!("{} {} {}", c(VertexKind::Smooth), c(VertexKind::Edge), c(VertexKind::Corner));
}
