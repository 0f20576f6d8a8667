//! Moving, turning and sizing the selected node: from a hand's movement in the world to a command.

use blobtree::{AffineMap, Command, NewShape, Node, NodePath, NodeRef, Shape, Transform, Warp};
use glam::{Affine3A, EulerRot, Mat3, Quat, Vec3};

/// A change of place in the world, about a fixed point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// By so many mm.
    Move(Vec3),
    /// About an axis (a unit vector) through a point, degrees.
    Turn {
        /// The fixed point, mm.
        about: Vec3,
        /// The axis, a unit vector.
        axis: Vec3,
        /// How far, counter-clockwise seen against the axis.
        degrees: f32,
    },
    /// Larger by a factor, the same in all directions.
    Scale {
        /// The fixed point, mm.
        about: Vec3,
        /// The factor, more than 0.
        factor: f32,
    },
}

/// The command that moves the node at `path`; `None` for a path that leads nowhere, and below warps that bend space,
/// where a motion in the world is none of the node.
pub fn command(root: &NodeRef, path: &NodePath, motion: Motion) -> Option<Command> {
    let node = path.find(root)?;
    let (holder, old) = match (&node.shape, path.parent()) {
        (Shape::Warp(Warp::Transform(transform), _), _) => (Some(path.clone()), transform.clone()),
        (_, Some(parent)) => match &parent.find(root)?.shape {
            Shape::Warp(Warp::Transform(transform), _) => (Some(parent), transform.clone()),
            _ => (None, Transform::default()),
        },
        _ => (None, Transform::default()),
    };
    let above = holder.as_ref().unwrap_or(path);
    let motion = within(root, above, motion)?;
    let new = moved(&old, motion)?;
    Some(match holder {
        Some(path) => Command::SetShape { path, shape: NewShape::Warp(Warp::Transform(new)) },
        None => Command::WrapInWarp { path: path.clone(), warp: Warp::Transform(new) },
    })
}

/// From the space of the node at a path to the world; `None` below warps that bend space.
pub fn world_from_node(root: &NodeRef, path: &NodePath) -> Option<Affine3A> {
    let mut all = Affine3A::IDENTITY;
    let mut node = root;
    for &index in &path.0 {
        if let Shape::Warp(warp, _) = &node.shape {
            all *= warp.parent_from_child()?;
        }
        node = node.children().get(index)?;
    }
    Some(all)
}

/// What puts a mirrored copy of the node at `path` beside it, on the other side of the plane x = 0 of the world. `None`
/// where no copy can stand beside it: below warps that bend space, and where there is no operator above.
pub fn mirrored(root: &NodeRef, path: &NodePath) -> Option<Command> {
    let (parent, index) = (path.parent()?, *path.0.last()?);
    let above = parent.find(root)?;
    if !matches!(above.shape, Shape::Operator(..)) {
        return None;
    }
    let copy = mirror(path.find(root)?, world_from_node(root, &parent)?);
    Some(Command::Insert { parent, index: index + 1, node: copy.into() })
}

/// A node mirrored at x = 0 of the world.
pub fn mirror(node: &NodeRef, world_from_parent: Affine3A) -> Node {
    let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let map = world_from_parent.inverse() * mirror * world_from_parent;
    let (linear, to) = (Mat3::from(map.matrix3), map.translation);
    let row = |axis: usize| {
        let row = linear.row(axis);
        [row.x, row.y, row.z, to[axis]]
    };
    let warp = Warp::Affine(AffineMap { rows: [row(0), row(1), row(2)] });
    Node::new(Shape::Warp(warp, node.clone()))
}

/// A motion of the world as it is seen in the space of the parent of the node at `path`.
fn within(root: &NodeRef, path: &NodePath, motion: Motion) -> Option<Motion> {
    let mut motion = motion;
    let mut node = root;
    for &index in &path.0 {
        if let Shape::Warp(warp, _) = &node.shape {
            let child_from_parent = warp.parent_from_child()?.inverse();
            let point = |p: Vec3| child_from_parent.transform_point3(p);
            let vector = |v: Vec3| child_from_parent.transform_vector3(v);
            motion = match motion {
                Motion::Move(by) => Motion::Move(vector(by)),
                Motion::Turn { about, axis, degrees } => {
                    let mirrored = Mat3::from(child_from_parent.matrix3).determinant() < 0.0;
                    let axis = vector(axis).try_normalize()?;
                    Motion::Turn {
                        about: point(about),
                        axis,
                        degrees: if mirrored { -degrees } else { degrees },
                    }
                }
                Motion::Scale { about, factor } => Motion::Scale { about: point(about), factor },
            };
        }
        node = node.children().get(index)?;
    }
    Some(motion)
}

/// The transform after a motion in its parent's space. `None` if numbers run away.
fn moved(old: &Transform, motion: Motion) -> Option<Transform> {
    let mut new = old.clone();
    match motion {
        Motion::Move(by) => new.translate += by,
        Motion::Turn { about, axis, degrees } => {
            let turn = Quat::from_axis_angle(axis, degrees.to_radians());
            let angles = old.rotate_degrees.to_array().map(f32::to_radians);
            let before = Quat::from_euler(EulerRot::ZYX, angles[2], angles[1], angles[0]);
            let (z, y, x) = (turn * before).to_euler(EulerRot::ZYX);
            new.rotate_degrees = Vec3::new(x, y, z).to_array().map(f32::to_degrees).into();
            new.translate = about + turn * (old.translate - about);
        }
        Motion::Scale { about, factor } => {
            new.scale *= factor;
            new.translate = about + factor * (old.translate - about);
        }
    }
    let is_sound = new.translate.is_finite() && new.rotate_degrees.is_finite() && new.scale.is_finite();
    is_sound.then_some(new)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{Build as _, cuboid, point, union};
    use blobtree::{Document, Field, Scene, Tree};

    /// The value of the scene at a place after a motion of the node at `path`.
    fn value_after(root: &NodeRef, path: &[usize], motion: Motion, at: Vec3) -> f32 {
        let mut document = Document::new(Scene::new(root.clone())).expect("legal");
        let command = command(root, &NodePath(path.to_vec()), motion).expect("it can move");
        document.apply(command).expect("it can be applied");
        Tree::new(&document.scene().root).value(at)
    }

    #[test]
    fn a_node_below_turned_and_sized_ones_moves_as_the_hand_does() {
        let inner = union([point([3., 1., 0.], 2.)]).rotate_degrees([0., 0., 70.]).scale([2., 3., 1.5]);
        let root: NodeRef = union([inner.translate([5., -4., 8.])]).into();
        let by = Vec3::new(1.5, -2.0, 0.7);
        let places = [Vec3::new(0.4, 3.0, 8.0), Vec3::new(2.0, 1.0, 9.0), Vec3::new(6.0, 2.0, 7.5)];
        let tree = Tree::new(&root);
        for place in places {
            let moved = value_after(&root, &[0, 0, 0, 0, 0], Motion::Move(by), place + by);
            assert!((moved - tree.value(place)).abs() < 1e-4);
        }
    }

    #[test]
    fn turning_and_sizing_leave_the_fixed_point_where_it_is() {
        let root: NodeRef = union([cuboid([10., 0., 5.], [6., 4., 10.])]).into();
        let about = Vec3::new(10.0, 0.0, 5.0);
        let turned = Motion::Turn { about, axis: Vec3::Z, degrees: 90.0 };
        let place = Vec3::new(11.5, 2.5, 3.0);
        // A quarter turn takes (x, y) from the middle to (-y, x).
        let before = Tree::new(&root).value(about + Vec3::new(2.5, -1.5, -2.0));
        assert!((value_after(&root, &[0], turned, place) - before).abs() < 1e-5);
        let sized = Motion::Scale { about, factor: 2.0 };
        let before = Tree::new(&root).value(about + 0.5 * (place - about));
        assert!((value_after(&root, &[0], sized, place) - before).abs() < 1e-5);
    }

    #[test]
    fn a_mirrored_copy_stands_on_the_other_side_also_below_turned_nodes() {
        let part = cuboid([12., 3., 5.], [6., 4., 10.]);
        let root: NodeRef =
            union([union([part]).rotate_degrees([0., 0., 30.]).translate([4., 0., 1.])]).into();
        let path = NodePath(vec![0, 0, 0, 0]);
        assert_eq!(path.find(&root).expect("a part").type_name(), "box");
        let mut document = Document::new(Scene::new(root.clone())).expect("legal");
        document.apply(mirrored(&root, &path).expect("it has a parent")).expect("it can be applied");
        let (before, after) = (Tree::new(&root), Tree::new(&document.scene().root));
        for place in [Vec3::new(13.0, 8.0, 6.0), Vec3::new(12.0, 10.0, 3.0), Vec3::new(15.5, 9.0, 9.0)] {
            let there = Vec3::new(-place.x, place.y, place.z);
            assert!((after.value(there) - before.value(place)).abs() < 1e-4);
            assert!((after.value(place) - before.value(place)).abs() < 1e-4);
        }
    }

    #[test]
    fn a_second_motion_changes_the_transform_that_the_first_one_made() {
        let root: NodeRef = union([point([0., 0., 0.], 5.)]).into();
        let mut document = Document::new(Scene::new(root)).expect("legal");
        for _ in 0..3 {
            let root = &document.scene().root;
            let next = command(root, &NodePath(vec![0]), Motion::Move(Vec3::X)).expect("it can move");
            document.apply(next).expect("it can be applied");
        }
        let Shape::Warp(Warp::Transform(transform), child) = &document.scene().root.children()[0].shape
        else {
            panic!("no transform")
        };
        assert_eq!((transform.translate, child.type_name()), (3.0 * Vec3::X, "point"));
    }
}
