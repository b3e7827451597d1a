"""Plants and their pots."""
