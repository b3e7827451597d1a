"""Measures of an episode that agents do not observe."""
