"""Materials for light and for sound."""
