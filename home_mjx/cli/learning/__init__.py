"""Subcommands that train agents and tell how good they are; one module each."""
