"""Lamps, candles, fans."""
