"""Round, swept, bent and leaf-shaped solids for models."""
