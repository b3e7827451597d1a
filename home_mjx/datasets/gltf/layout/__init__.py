"""Layout of a scene as a house: storeys, rooms and walls, found from its triangles or stated by a file."""
