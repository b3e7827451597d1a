"""Shading of `lit` and `baked` in compiled code: one kernel from hits to light, and one cast of shadow rays."""
