"""Sport, music, garage and garden."""
