"""Helpers without a domain: checks of options, pytrees, transforms, colour, files, images, folders, workers."""
