//! What is kept from one start to the next, by the names that are on the screen.

mod common;

use blobtree::Scene;
use blobtree::build::{point, union};
use common::*;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use modeler::settings::{Habit, Theme};
use std::path::Path;

/// A screen whose modeler keeps things in this folder.
fn kept_in(folder: &Path) -> Screen {
    screen_with(None, |modeler| modeler.keep_in(folder))
}

#[test]
fn settings_of_the_menus_are_there_at_the_next_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut first = kept_in(folder.path());
    press(&mut first, "View");
    press(&mut first, "For left-handed people");
    press(&mut first, "View");
    first.get_by_label("Light and dark").hover();
    first.run_steps(4);
    press(&mut first, "Light");
    first.state_mut().settings.habit = Habit::Tinkercad;
    first.state_mut().settings.scale = 1.25;
    settle(&mut first);
    drop(first);
    let mut second = kept_in(folder.path());
    let settings = second.state().settings;
    assert!(settings.left_handed && settings.theme == Theme::Light && settings.habit == Habit::Tinkercad);
    assert!(!second.ctx.global_style().visuals.dark_mode && (second.ctx.zoom_factor() - 1.25).abs() < 1e-3);
    // Keys change the size, too.
    second.ctx.set_zoom_factor(1.5);
    second.run_steps(3);
    assert!((second.state().settings.scale - 1.5).abs() < 1e-3);
}

#[test]
fn files_worked_on_lately_are_offered_with_pictures_and_those_that_are_gone_are_grey() {
    let folder = tempfile::tempdir().expect("a folder");
    let state = folder.path().join("state");
    let [one, two] = ["one.trullo", "two.trullo"].map(|name| folder.path().join(name));
    let mut first = kept_in(&state);
    for (file, radius) in [(&one, 5.0), (&two, 9.0)] {
        first.state_mut().put(Scene::new(union([point([0., 0., radius], radius)])), None);
        assert!(save(&mut first, file));
    }
    until(&mut first, |screen| screen.state().kept.recent.iter().all(|recent| recent.picture.is_some()));
    drop(first);
    std::fs::remove_file(&two).expect("it is there");
    let mut second = kept_in(&state);
    until(&mut second, |screen| {
        let recent = &screen.state().kept.recent;
        recent.len() == 2 && recent.iter().all(|recent| recent.picture.is_some()) && !recent[0].is_there
    });
    second.run_steps(2);
    assert!(second.get_by_role_and_label(egui::Role::Button, "two.trullo").accesskit_node().is_disabled());
    second.get_by_role_and_label(egui::Role::Button, "one.trullo").click();
    settle(&mut second);
    assert_eq!(second.state().bench.file(), Some(&*one));
    press(&mut second, "File");
    second.get_by_label("Open again").hover();
    second.run_steps(4);
    press(&mut second, "Forget those that are gone");
    assert_eq!(second.state().kept.recent.len(), 1);
}
