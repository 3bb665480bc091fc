//! Nearest-neighbour structures.
