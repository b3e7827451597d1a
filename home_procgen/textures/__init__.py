"""Texture images by recipe: floors, walls, fabrics, woods, rugs and pictures."""
