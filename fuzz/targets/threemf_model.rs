#![no_main]

trullo_fuzz::target!(|data| trullo_fuzz::read_mesh(
    &trullo_fuzz::package_of(data),
    mesh::io::Format::ThreeMf
));
