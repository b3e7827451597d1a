"""Validator rules beyond those of the reader; each module has one function of a `ValidationContext`."""
