"""Homes of the second generator: plans of several storeys, and many things in many shapes."""
