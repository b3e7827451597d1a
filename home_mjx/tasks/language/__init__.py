"""Vocabulary, phrases and tokens of task instructions."""
