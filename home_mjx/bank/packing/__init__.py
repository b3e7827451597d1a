"""Packing of compiled houses into the arrays of a bank; host only, NumPy."""
