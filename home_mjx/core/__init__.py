"""What knows no domain: checks of options, pytrees, transforms, colour, files, images, folders, worker processes."""
