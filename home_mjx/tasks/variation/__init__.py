"""Domain randomisation: ranges in the options, and the samples of each episode."""
