"""Cups, plates, pans, food."""
