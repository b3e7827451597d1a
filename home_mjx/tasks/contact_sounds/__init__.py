"""Contact sounds of an environment: footsteps, impacts, sliding bodies and doors."""
