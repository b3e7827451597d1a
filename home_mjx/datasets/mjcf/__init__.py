"""Houses from MJCF scenes of MuJoCo."""
