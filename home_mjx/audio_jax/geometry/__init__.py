"""Acoustic geometry independent of houses: image sources, diffraction paths around boxes, wedge diffraction."""
