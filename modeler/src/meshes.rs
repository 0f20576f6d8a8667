//! Meshes that a scene names by their way from the scene's folder, when the scene goes to another folder.

use blobtree::{
    Command, Document, ImportedMesh, MeshReference, NewShape, NodePath, NodeRef, Primitive, Scene, Shape,
};
use std::io;
use std::path::Path;

/// What makes the meshes of a tree, named from one folder, be named from another.
///
/// Errors: a mesh or a folder that is not there.
pub fn renamed(root: &NodeRef, from: &Path, to: &Path) -> io::Result<Vec<Command>> {
    let mut commands = Vec::new();
    let mut waiting = vec![(root.clone(), NodePath::default())];
    while let Some((node, path)) = waiting.pop() {
        if let Shape::Primitive(Primitive::Mesh(mesh)) = &node.shape {
            let file = MeshReference::way(to, &from.join(&mesh.file))?;
            if file != mesh.file {
                let mesh = ImportedMesh { file, ..mesh.clone() };
                commands.push(Command::SetShape { path, shape: NewShape::Primitive(Primitive::Mesh(mesh)) });
            }
            continue;
        }
        let children = node.children().iter().enumerate();
        waiting.extend(children.map(|(index, child)| (child.clone(), path.child(index))));
    }
    Ok(commands)
}

/// A scene that names its meshes from one folder, naming them from another.
///
/// Errors: a mesh or a folder that is not there.
pub fn moved(scene: &Scene, from: &Path, to: &Path) -> io::Result<Scene> {
    let commands = renamed(&scene.root, from, to)?;
    if commands.is_empty() {
        return Ok(scene.clone());
    }
    let mut document = Document::new(scene.clone()).map_err(io::Error::other)?;
    for command in commands {
        document.apply(command).map_err(io::Error::other)?;
    }
    Ok(document.scene().clone())
}

/// Whether there is a mesh in a tree.
pub fn any(root: &NodeRef) -> bool {
    matches!(&root.shape, Shape::Primitive(Primitive::Mesh(_))) || root.children().iter().any(any)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{Build as _, point, primitive, union};
    use glam::Vec3;
    use mesh::MeshDistance;
    use std::sync::Arc;

    #[test]
    fn a_mesh_is_found_from_the_folder_that_the_scene_goes_to() {
        let top = tempfile::tempdir().expect("a folder");
        let [from, to] = ["models/meshes", "scenes"].map(|name| top.path().join(name));
        for folder in [&from, &to] {
            std::fs::create_dir_all(folder).expect("there is room");
        }
        std::fs::write(from.join("box.stl"), "").expect("there is room");
        let distance =
            Arc::new(MeshDistance::new(&mesh::shapes::cuboid(Vec3::ZERO, Vec3::ONE)).expect("a sound mesh"));
        let file = "box.stl".to_owned();
        let mesh = ImportedMesh { file, sha256: String::new(), falloff: 5.0, distance };
        let node = primitive(Primitive::Mesh(mesh)).translate([1., 0., 0.]);
        let root: NodeRef = union([point([0., 0., 0.], 1.), node]).into();
        let renamed = renamed(&root, &from, &to).expect("all is there");
        let [Command::SetShape { path, shape: NewShape::Primitive(Primitive::Mesh(mesh)) }] = &renamed[..]
        else {
            panic!("{renamed:?}")
        };
        assert_eq!((path, &*mesh.file), (&NodePath(vec![1, 0]), "../models/meshes/box.stl"));
        assert!(super::renamed(&root, &from, &from).expect("all is there").is_empty());
        assert!(super::renamed(&root, &to, &from).is_err());
    }
}
