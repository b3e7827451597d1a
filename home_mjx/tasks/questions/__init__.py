"""Tasks in which agents speak: questions about houses, a dialogue with an oracle, telling each other."""
