"""Tasks with speech: questions about houses, dialogues with an oracle, communication between agents."""
