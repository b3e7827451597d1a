"""What is to be built: types of rooms, and what each type needs."""
