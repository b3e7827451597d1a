"""Room program and shape of homes: rows of rooms along halls, storeys, and rooms with cut-off corners."""
