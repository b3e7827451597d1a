"""Impulse responses of receivers, clips, frames of sound, and audio features."""
