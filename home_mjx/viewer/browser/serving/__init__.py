"""Serving the viewer: the page, its channels, viser behind one port, and which page drives which agent."""
