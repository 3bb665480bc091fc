//! Builds again when the page was built again: nothing else tells cargo of files that come or go in its folder.

fn main() {
    println!("cargo::rerun-if-changed=page/dist");
}
