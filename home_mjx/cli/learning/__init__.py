"""Subcommands that play, record, train and evaluate agents, one module each."""
