"""Tools and garden things."""
