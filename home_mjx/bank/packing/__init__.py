"""Compiled houses into the arrays of a bank; host only, NumPy."""
