//! Seeded scenes with a known truth.
