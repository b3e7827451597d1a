"""Gallery: several houses side by side in one 3D scene, with the findings of the validator where they are."""
