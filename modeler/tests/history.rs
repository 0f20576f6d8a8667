//! What was done, to be read and gone back to, by the names that are on the screen.

mod common;

use common::*;

#[test]
fn one_goes_back_to_any_step_and_forward_again() {
    let (mut screen, _) = screen_with_two_balls();
    screen.state_mut().duplicate_selected();
    settle(&mut screen);
    let parts = |screen: &Screen| screen.state().bench.scene().root.children().len();
    let names: Vec<String> = screen.state().bench.document().undo_names().map(str::to_owned).collect();
    let after = screen.state().bench.scene().clone();
    assert_eq!(names, ["Add inflation", "Blend with inflation", "Add inflation"]);
    press(&mut screen, "The beginning");
    assert_eq!(parts(&screen), 0);
    assert_eq!(screen.state().bench.document().redo_names().count(), 3);
    press(&mut screen, &format!("2. {}", names[1]));
    assert_eq!(screen.state().bench.document().undo_names().count(), 2);
    press(&mut screen, &format!("3. {}", names[0]));
    assert_eq!(screen.state().bench.scene(), &after);
}
