"""Subcommands of `home-mjx` for houses and diagnostics, one module each."""
