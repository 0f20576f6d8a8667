//! States of a document side by side, by the names that are on the screen.

mod common;

use blobtree::Scene;
use blobtree::build::{Build as _, point, union};
use common::*;
use egui_kittest::kittest::Queryable as _;
use modeler::How;
use modeler::desk::Desk as _;
use modeler::journal::LeftBehind;
use modeler::workbench::Workbench;

fn parts(screen: &Screen) -> Vec<String> {
    let children = screen.state().bench.scene().root.children();
    children.iter().map(|node| node.name.clone().unwrap_or_default()).collect()
}

fn in_hand(screen: &Screen) -> String {
    screen.state().bench.variants().name().to_owned()
}

/// A head and a hat, in a second variant without the hat.
fn two_variants(sessions: Option<std::path::PathBuf>) -> Screen {
    let mut screen = screen(sessions);
    let (head, hat) = (point([0., 0., 9.], 9.).named("head"), point([0., 0., 20.], 5.).named("hat"));
    screen.state_mut().put(Scene::new(union([head, hat])), None);
    settle(&mut screen);
    press(&mut screen, "Variants");
    press(&mut screen, "New variant");
    screen.state_mut().select(Some(blobtree::NodePath(vec![1])));
    screen.state_mut().remove_selected();
    settle(&mut screen);
    screen
}

#[test]
fn a_variant_is_kept_beside_the_other_and_a_part_is_taken_from_it_in_one_step() {
    let mut screen = two_variants(None);
    assert_eq!((in_hand(&screen), parts(&screen)), ("Variant 2".into(), vec!["head".into()]));
    press(&mut screen, "Variant 1");
    assert_eq!((in_hand(&screen), parts(&screen)), ("Variant 1".into(), vec!["head".into(), "hat".into()]));
    press(&mut screen, "Variant 2");
    press(&mut screen, "Take a part");
    // The tree has no hat now, so this is the menu's.
    press(&mut screen, "hat");
    assert_eq!(parts(&screen), ["head", "hat"]);
    let undo: Vec<&str> = screen.state().bench.document().undo_names().collect();
    assert_eq!(undo[0], "Add hat");
    press(&mut screen, "Undo");
    assert_eq!(parts(&screen), ["head"]);
    press(&mut screen, "Remove");
    assert!(screen.state().bench.variants().all().count() == 1 && screen.query_by_label("Remove").is_none());
}

#[test]
fn variants_are_saved_with_the_scene_and_opened_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("two.trullo");
    let mut screen = two_variants(None);
    assert!(screen.state().bench.is_unsaved());
    assert!(save(&mut screen, &file));
    screen.state_mut().put(Workbench::empty_page(), None);
    settle(&mut screen);
    screen.state_mut().fetch(file.clone(), How::Instead);
    settle(&mut screen);
    assert_eq!((in_hand(&screen), parts(&screen)), ("Variant 2".into(), vec!["head".into()]));
    press(&mut screen, "Variant 1");
    assert_eq!(parts(&screen), ["head", "hat"]);
    // Whoever knows nothing of variants sees the one in hand.
    let text = std::fs::read(&file).expect("it is there");
    let scene = Scene::from_bytes(&text, &mut blobtree::NoSources).expect("legal");
    assert_eq!(scene.root.children().len(), 1);
}

#[test]
fn variants_outlive_a_crash_with_their_histories() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut screen = two_variants(Some(folder.path().into()));
    press(&mut screen, "Variant 1");
    press(&mut screen, "New variant");
    press(&mut screen, "Variant 2");
    let before = screen.state().bench.variants().clone();
    drop(screen);
    let left = LeftBehind::all(folder.path()).pop().expect("a session");
    let recovered = left.recover(&mut *TestDesk.sources(None)).expect("it is sound");
    assert_eq!(recovered.lost, None);
    assert_eq!(recovered.variants.whole().to_text(), before.whole().to_text());
    assert_eq!(recovered.variants.name(), "Variant 2");
    let undo = |variants: &modeler::variants::Variants| variants.document().undo_names().count();
    assert_eq!((undo(&recovered.variants), undo(&before)), (1, 1));
}
