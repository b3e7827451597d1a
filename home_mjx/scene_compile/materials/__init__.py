"""Optical, acoustic and contact properties of materials."""
