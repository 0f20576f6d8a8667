#![no_main]

trullo_fuzz::target!(|data| trullo_fuzz::draw(data));
