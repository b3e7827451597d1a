"""Sensors of agents."""

from home_mjx.tasks.base.config import DEFAULT_SENSORS, SENSORS
from home_mjx.tasks.base.snapshot import BodyContacts, ContactSemantics, contact_semantics

__all__ = [
    "DEFAULT_SENSORS",
    "SENSORS",
    "BodyContacts",
    "ContactSemantics",
    "contact_semantics",
]
