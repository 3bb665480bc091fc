//! The `zeroset` command.

fn main() {}
