"""Exploration, and PiedPiper with its scripted agents."""
