"""Serving the viewer: the page, its channels and viser behind one port."""
