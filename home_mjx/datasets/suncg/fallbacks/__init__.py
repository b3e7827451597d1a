"""Stand-ins for what a partial copy of a dataset lacks: models, meshes of rooms, rows of tables."""
