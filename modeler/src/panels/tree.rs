//! The tree: what the model is made of, to be selected, named, muted, coloured and moved about.

use super::edit;
use crate::modeler::Modeler;
use crate::seams;
use crate::settings::Tool;
use crate::theme;
use blobtree::{AffineMap, Color, Node, NodePath, NodeRef, Operator, Shape, Sharpness, Warp};
use egui::{
    Color32, DragAndDrop, FontId, Id, LayerId, Order, Rect, Response, RichText, ScrollArea, Sense, Ui,
    collapsing_header,
};
use glam::Vec3;

/// Nodes below which branches begin closed.
const OPEN_UP_TO: usize = 40;

/// How far lines are indented for each level, points.
const INDENT: f32 = 12.0;

/// How far at most, in levels.
const DEEPEST: usize = 12;

/// The size of a node's picture, points.
const PICTURE: egui::Vec2 = egui::vec2(24.0, 18.0);

/// Most pictures at a time.
const MOST_PICTURES: usize = 100;

/// What is done with a node that is dragged onto another.
#[derive(Clone, Debug, PartialEq)]
struct Dragged(NodePath);

/// What was done in the tree.
#[derive(Default)]
struct Done {
    selected: Option<NodePath>,
    /// Whether it is selected with what is selected.
    too: bool,
    hovered: Option<NodePath>,
    /// The nodes that can be seen.
    seen: Vec<NodeRef>,
    /// What was dragged, and what it was dropped on.
    dropped: Option<(NodePath, NodePath)>,
    /// What the menu does with all selected nodes.
    act: Option<edit::Act>,
}

/// Shows it.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    ui.strong("Parts");
    let root = modeler.bench.scene().root.clone();
    let mut done = Done::default();
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        if root.children().is_empty() && matches!(root.shape, Shape::Operator(..)) {
            ui.weak("Nothing yet. Draw a closed outline in the middle.");
        } else {
            lines(modeler, ui, &root, &mut done);
        }
    });
    modeler.hovered = done.hovered;
    modeler.show_parts(done.seen, ui.ctx());
    match done.selected {
        Some(path) if done.too => modeler.select_too(path),
        Some(path) => modeler.select(Some(path)),
        None => {}
    }
    if let Some(act) = done.act {
        act(modeler);
    }
    if let Some((dragged, onto)) = done.dropped {
        modeler.drop_in_tree(&dragged, &onto);
    }
    show_dragged(modeler, ui);
}

/// What is being dragged, beside the pointer.
fn show_dragged(modeler: &Modeler, ui: &Ui) {
    let Some(dragged) = DragAndDrop::payload::<Dragged>(ui.ctx()) else { return };
    let Some(at) = ui.input(|input| input.pointer.latest_pos()) else { return };
    let moved = modeler.moved_with(&dragged.0);
    let text = match &moved[..] {
        [only] => only.find(&modeler.bench.scene().root).map(|node| title(node)).unwrap_or_default(),
        several => format!("{} parts", several.len()),
    };
    let painter = ui.ctx().layer_painter(LayerId::new(Order::Tooltip, Id::unique("dragged")));
    let color = ui.visuals().strong_text_color();
    let galley = painter.layout_no_wrap(text, FontId::proportional(14.0), color);
    let place = Rect::from_min_size(at + egui::vec2(14.0, 6.0), galley.size());
    painter.rect_filled(place.expand(4.0), 3.0, ui.visuals().window_fill);
    painter.galley(place.min, galley, color);
}

/// All nodes that show, line by line. Trees may be deep, and lines in lines in lines would need much of the stack.
fn lines(modeler: &Modeler, ui: &mut Ui, root: &NodeRef, done: &mut Done) {
    ui.spacing_mut().indent = INDENT;
    let mut waiting = vec![(root.clone(), NodePath::default())];
    while let Some((node, path)) = waiting.pop() {
        let is_open = ui.horizontal(|ui| line(modeler, ui, &node, &path, done)).inner;
        if is_open {
            let children = node.children().iter().enumerate().rev();
            waiting.extend(children.map(|(index, child)| (child.clone(), path.child(index))));
        }
    }
}

/// One node; whether those below it show.
fn line(modeler: &Modeler, ui: &mut Ui, node: &NodeRef, path: &NodePath, done: &mut Done) -> bool {
    let indent = ui.spacing().indent;
    ui.add_space(indent * path.0.len().min(DEEPEST) as f32);
    if node.children().is_empty() {
        ui.add_space(indent);
        row(modeler, ui, node, path, done);
        return false;
    }
    let id = Id::unique("branch").with(path);
    let open = path.0.len() < 2 || node.children().len() <= OPEN_UP_TO && path.0.len() < DEEPEST;
    let mut state = collapsing_header::CollapsingState::load_with_default_open(ui.ctx(), id, open);
    state.show_toggle_button(ui, collapsing_header::paint_default_icon);
    let is_open = state.is_open();
    state.store(ui.ctx());
    row(modeler, ui, node, path, done);
    is_open
}

fn row(modeler: &Modeler, ui: &mut Ui, node: &NodeRef, path: &NodePath, done: &mut Done) {
    let is_selected = modeler.bench.selection().contains(path);
    let name = title(node);
    let mut text = RichText::new(&name);
    if !node.is_heard() {
        text = text.weak().strikethrough();
    }
    if let Some(Color([r, g, b])) = node.color {
        let (rect, _) = ui.allocate_exact_size(egui::vec2(10.0, 14.0), Sense::hover());
        ui.painter().rect_filled(rect.shrink(1.0), 2.0, Color32::from_rgb(r, g, b));
    }
    if let (Shape::Operator(operator, _), true) = (&node.shape, modeler.settings.shows_seams) {
        // As its seams on the model.
        let [r, g, b] = seams::color(operator);
        let (rect, _) = ui.allocate_exact_size(egui::vec2(4.0, 16.0), Sense::hover());
        ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
    }
    let picture = picture(modeler, ui, node, done);
    let button = ui.add(egui::Button::selectable(is_selected, text).sense(Sense::click_and_drag())) | picture;
    // What is under the pointer in the view lights up here.
    if modeler.pointed() == Some(path) {
        let light = egui::Stroke::new(2.0, theme::pointed(ui.visuals().dark_mode));
        ui.painter().rect_stroke(button.rect, 3.0, light, egui::StrokeKind::Inside);
    }
    button.dnd_set_drag_payload(Dragged(path.clone()));
    if button.hovered() {
        done.hovered = Some(path.clone());
    }
    if button.clicked() {
        let held = ui.input(|input| input.modifiers.shift || input.modifiers.command);
        (done.selected, done.too) = (Some(path.clone()), held || modeler.settings.tool == Tool::Select);
    }
    // Its menu is about all that is selected, so it is one of them.
    if button.secondary_clicked() && !is_selected {
        (done.selected, done.too) = (Some(path.clone()), false);
    }
    dropped(path, &button, ui, done);
    button.context_menu(|ui| done.act = edit::parts(modeler, ui));
}

/// What the node makes by itself; it can be tapped and dragged as its name can.
fn picture(modeler: &Modeler, ui: &mut Ui, node: &NodeRef, done: &mut Done) -> Response {
    // The keyboard stops at the name alone.
    let (rect, response) = ui.allocate_exact_size(PICTURE, Sense::CLICK | Sense::DRAG);
    if ui.is_rect_visible(rect) && done.seen.len() < MOST_PICTURES {
        done.seen.push(node.clone());
        if let Some(texture) = modeler.parts.of(node) {
            let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
            ui.painter().image(texture.id(), rect, whole, Color32::WHITE);
        }
    }
    response
}

/// Takes in a node that is dropped on this one.
fn dropped(path: &NodePath, button: &Response, ui: &Ui, done: &mut Done) {
    if button.dnd_hover_payload::<Dragged>().is_some() {
        ui.painter().rect_stroke(
            button.rect,
            3.0,
            egui::Stroke::new(2.0, ui.visuals().selection.stroke.color),
            egui::StrokeKind::Outside,
        );
    }
    if let Some(dragged) = button.dnd_release_payload::<Dragged>() {
        done.dropped = Some((dragged.0.clone(), path.clone()));
    }
}

/// The operators with the names that the user reads.
pub fn operators() -> [(&'static str, Operator); 8] {
    [
        ("Together", Operator::Union),
        ("Blended", Operator::Blend(Sharpness::DEFAULT)),
        ("Blended where they meet", Operator::GradientBlend),
        ("Blended widely", Operator::Sum),
        ("First without the others", Operator::Difference),
        ("First without the others, soft", Operator::BlendDifference(Sharpness::DEFAULT)),
        ("What they share", Operator::Intersection),
        ("What they share, soft", Operator::BlendIntersection(Sharpness::DEFAULT)),
    ]
}

/// How an operator makes its value of those of its parts, in words.
pub fn rule(operator: &Operator) -> &'static str {
    match operator {
        Operator::Union => "the largest value counts",
        Operator::Blend(_) => "added softly: the sharper, the more the largest counts",
        Operator::GradientBlend => "added where surfaces meet at an angle, else the largest counts",
        Operator::Sum => "all values are added",
        Operator::Difference => "the first, but no more than 1 minus each of the others",
        Operator::BlendDifference(_) => "the first, softly held below 1 minus each of the others",
        Operator::Intersection => "the smallest value counts",
        Operator::BlendIntersection(_) => "the smallest value counts, softly",
    }
}

/// What a warp makes of what is below it, in a word.
fn made(warp: &Warp) -> &'static str {
    match warp {
        Warp::Transform(_) => "Moved",
        Warp::Affine(map) => match is_mirror(map) {
            true => "Mirrored",
            false => "Skewed",
        },
        Warp::Taper(_) => "Tapered",
        Warp::Twist(_) => "Twisted",
        Warp::Bend(_) => "Bent",
    }
}

/// Whether a map turns left into right.
fn is_mirror(map: &AffineMap) -> bool {
    let [x, y, z] = map.rows.map(|[x, y, z, _]| Vec3::new(x, y, z));
    x.dot(y.cross(z)) < 0.0
}

/// What the user reads for a node: its name, else what it is. A warp is what it makes of the part below.
pub fn title(node: &Node) -> String {
    if let Some(name) = &node.name {
        return name.clone();
    }
    if let Shape::Operator(operator, _) = &node.shape {
        let same = |other: &Operator| std::mem::discriminant(other) == std::mem::discriminant(operator);
        if let Some((name, _)) = operators().into_iter().find(|(_, other)| same(other)) {
            return name.into();
        }
    }
    if let Shape::Warp(warp, child) = &node.shape {
        let mut part = child;
        while let (None, Shape::Warp(_, below)) = (&part.name, &part.shape) {
            part = below;
        }
        let part = part.name.clone().unwrap_or_else(|| title(part).to_lowercase());
        return format!("{} {part}", made(warp));
    }
    let type_name = node.type_name().replace('_', " ");
    let mut letters = type_name.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{Build as _, point, union};

    #[test]
    fn what_is_moved_is_named_after_the_part_that_moves() {
        let ball = || point([0.; 3], 5.);
        assert_eq!(title(&ball().translate([1., 0., 0.])), "Moved point");
        assert_eq!(title(&ball().named("Belly").translate([1., 0., 0.])), "Moved Belly");
        let both = union([ball(), ball()]).translate([1., 0., 0.]).translate([0., 0., 9.]);
        assert_eq!(title(&both), "Moved together");
        assert_eq!(title(&both.named("Pair")), "Pair");
        let mirrored = crate::placing::mirror(&ball().into(), glam::Affine3A::IDENTITY);
        assert_eq!(title(&mirrored), "Mirrored point");
    }
}
