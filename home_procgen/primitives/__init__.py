"""Solids, joinery, colours and textures of furniture."""
