"""What `home-mjx demo` does: a scripted walk, its pictures, film, sound and figures."""
