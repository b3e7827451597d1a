"""Ears, microphones and the diffuse field around them."""
