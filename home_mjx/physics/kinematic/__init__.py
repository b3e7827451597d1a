"""Physics without dynamics: agents move by their actions and slide along obstacles; bodies stay unless held.

This suffices for pure navigation, as with Habitat's default agents, and costs a small part of contact dynamics.
"""
