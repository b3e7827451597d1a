"""Curtains, rugs, cushions, clothes."""
