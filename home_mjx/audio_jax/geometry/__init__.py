"""Lines and planes of sound without a house: image sources, and strings around edges of boxes."""
