"""Images from rays: cameras, what they see, and how it is shaded."""
