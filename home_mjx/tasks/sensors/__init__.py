"""Sensors of agents."""
