//! Chores of the repository: `cargo xtask CHORE`.

fn main() {}
