//! Keeps panics of decoding libraries inside.
//!
//! A damaged file can make a decoder of somebody else's panic. For the caller that is one more way for the file to be
//! damaged, so it becomes an error, and the default hook's two lines on standard error are kept back.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work`; a panic in it comes back as its message.
///
/// The first call wraps the process's panic hook, so that panics inside `work` print nothing; all others reach the
/// hook that was there before.
pub(crate) fn without_panic<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = take_hook();
        set_hook(Box::new(move |info| {
            if !QUIET.get() {
                previous(info);
            }
        }));
    });
    let before = QUIET.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work));
    QUIET.set(before);
    result.map_err(|payload| {
        let text = payload.downcast_ref::<&str>().map(|s| (*s).to_string());
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
        text.unwrap_or_else(|| "the decoder stopped".into())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_its_message() {
        assert_eq!(without_panic(|| 3), Ok(3));
        let index = std::hint::black_box(7);
        let caught = without_panic(|| [1, 2, 3][index]);
        assert!(caught.is_err_and(|message| message.contains("out of bounds")));
    }
}
