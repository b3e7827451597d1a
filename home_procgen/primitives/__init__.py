"""Solids, joinery, colours and textures that furniture is made of."""
