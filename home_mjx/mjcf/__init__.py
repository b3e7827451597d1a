"""MJCF fragments that exported houses and the physics template share: agents, boxes, contacts."""
