"""Baking of late reverberation, once per house: energy between cells of its rooms, per octave and time."""
