"""Impulse responses at two ears, clips, and frames of sound."""
