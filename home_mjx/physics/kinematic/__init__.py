"""Agents without dynamics: they move as told and slide along what is in the way. Things stay unless held.

What pure navigation needs, and what Habitat's agents do by default, at a small part of the cost of contacts.
"""
