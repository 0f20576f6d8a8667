//! The documents and examples beside the code say what the code does.
