//! Fields to meshes.
