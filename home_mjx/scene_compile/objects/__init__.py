"""Objects in the house: placed, weighed, doors cut into frame and leaves."""
