//! What a support-free node promises, judged by closed forms and by brute force.

mod brushes;
mod common;
mod field;
mod grow;
mod materials;
mod preserve;
mod settle;
mod store;
mod trim;
mod why;
