"""States of lamps and appliances: on or off, per environment; their light, glow and sound; toggling by pointing."""
