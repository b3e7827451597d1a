"""The shape of homes: rows of rooms along halls, storeys, rooms with corners cut off."""
