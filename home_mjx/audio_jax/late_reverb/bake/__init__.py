"""Late sound computed once per house: between cells of its rooms, per octave and time."""
