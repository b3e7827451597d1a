"""Reader of 3D-FRONT's houses with the models of 3D-FUTURE."""
