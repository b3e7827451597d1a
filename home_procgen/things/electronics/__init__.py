"""Screens, sound, telephones, cleaning devices."""
