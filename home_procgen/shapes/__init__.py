"""Round, swept, bent and leafy solids, from which things are made."""
