"""Cabinets, shelves, wardrobes and stands."""
