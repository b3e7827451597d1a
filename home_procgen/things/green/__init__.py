"""Plants, curtains, rugs, pillows, pictures, vases: what makes a room a home."""
