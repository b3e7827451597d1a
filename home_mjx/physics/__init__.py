"""Agents and movable objects in houses, stepped by MJX: one compiled model for all houses of a capacity.

Usable alone:

    template = Template(PhysicsConfig(), bank.spec)
    data = reset(template, bank, house, agent_pos, agent_yaw)
    data = step(template, bank, house, data, action)
"""

from home_mjx.physics import quiet_mjx as _first  # noqa: F401
from home_mjx.physics.config import PhysicsConfig
from home_mjx.physics.dynamics import (
    Template,
    agent_contact,
    agent_pose,
    agent_velocity,
    body_pose,
    is_broken,
    reset,
    step,
    step_checked,
    undo_where,
)
from home_mjx.physics.lost import Lost

__all__ = [
    "Lost",
    "PhysicsConfig",
    "Template",
    "agent_contact",
    "agent_pose",
    "agent_velocity",
    "body_pose",
    "is_broken",
    "reset",
    "step",
    "step_checked",
    "undo_where",
]
