"""The `home-mjx demo` command: a scripted walk with images, a film, sound and measurements."""
