"""Late reverberation of houses, baked once from rays and looked up in every step."""
