"""Reader of glTF 2.0: container, accessors, scene graph, materials, and the house that they show."""
