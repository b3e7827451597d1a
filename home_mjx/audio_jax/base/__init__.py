"""Options, air, filters, acoustic measures."""
