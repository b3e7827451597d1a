"""Domain randomisation: ranges that a user gives, and what an episode draws from them."""
