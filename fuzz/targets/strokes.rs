#![no_main]

trullo_fuzz::target!(|data| trullo_fuzz::read_strokes(data, sketch::stroke::FileFormat::Strokes));
