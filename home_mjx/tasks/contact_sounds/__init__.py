"""When bodies of an environment make a noise: steps, blows, what slides, and doors."""
