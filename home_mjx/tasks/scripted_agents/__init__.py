"""Tasks with experts of their own, or that lead agents themselves."""
