"""Options, sources and listeners, air absorption, octave filters, fractional delays."""
