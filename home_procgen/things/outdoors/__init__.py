"""Tools and garden equipment."""
