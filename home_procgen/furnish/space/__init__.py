"""Space of a room: occupied and reserved boxes, and placement of objects on floors, walls, ceilings and objects."""
