"""Lights and glossy surfaces of a house."""
