//! Point cloud and mesh formats for `zeroset`.
