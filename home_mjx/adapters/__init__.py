"""Thin views of the environments for other libraries, a module each."""
