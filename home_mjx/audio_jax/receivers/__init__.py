"""Receivers: HRTFs, microphones, ambisonics, and their coherence in diffuse fields."""
