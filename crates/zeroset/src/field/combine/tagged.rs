//! Fields that can be told apart again.

use std::sync::Arc;

use crate::field::{Field, Operand, Placement};

/// A field with a number, which [`Field::operand`] tells of its sheets.
#[derive(Debug)]
pub struct Tagged(Arc<dyn Field>, usize);

impl Tagged {
    /// A field with a number.
    #[must_use]
    pub fn new(field: Arc<dyn Field>, tag: usize) -> Self {
        Self(field, tag)
    }
}

super::forwarded!(Tagged, |tagged, _| Operand {
    tag: Some(tagged.1),
    placement: Placement::default(),
    is_reversed: false,
});
