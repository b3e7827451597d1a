"""Room programs: types of rooms to build, and the requirements of each type."""
