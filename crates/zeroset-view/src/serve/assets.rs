//! The page, as `cargo xtask web` built it.

use std::borrow::Cow;

use rust_embed::RustEmbed;

/// What is in the folder `page/dist` when this crate is built; nothing if the page was not built before.
#[derive(RustEmbed)]
#[folder = "page/dist"]
#[allow_missing = true]
struct Built;

/// The page itself; `None` in a build without it.
pub(super) fn page() -> Option<Cow<'static, [u8]>> {
    Built::get("index.html").map(|file| file.data)
}

/// A file beside the page, with its media type.
pub(super) fn beside(name: &str) -> Option<(&'static str, Cow<'static, [u8]>)> {
    let media_type = match name.rsplit_once('.')?.1 {
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        _ => return None,
    };
    Some((media_type, Built::get(name)?.data))
}
