"""Screens, sound, telephones, cleaning."""
