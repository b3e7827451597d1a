"""One module per subcommand of `home-mjx`."""
