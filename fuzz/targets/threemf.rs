#![no_main]

trullo_fuzz::target!(|data| trullo_fuzz::read_mesh(data, mesh::io::Format::ThreeMf));
