"""Episodes of a task to look at: played by an expert, a trained agent, chance or a person, and filmed."""
