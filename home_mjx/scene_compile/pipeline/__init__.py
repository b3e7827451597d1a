"""Stages of the compiler, in order."""
