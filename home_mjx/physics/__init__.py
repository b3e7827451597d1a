"""Rigid-body physics of agents, movable objects and doors. One model serves all houses of a capacity.

A control step runs in MJX, C MuJoCo, a fused kernel, or without dynamics; see `PhysicsConfig.impl`.

Standalone use:

    template = Template(PhysicsConfig(), bank.spec)
    state = reset(template, bank, house, agent_pos, agent_yaw)
    state = step(template, bank, house, state, action)

Exported houses are imported on first use, because they need the compiler of houses.
"""

import importlib
from typing import TYPE_CHECKING, Any

from home_mjx.physics.base.config import PhysicsConfig, PhysicsSetup
from home_mjx.physics.base.state import BodyScale, PhysicsState
from home_mjx.physics.dynamics import (
    agent_contact,
    agent_pose,
    agent_velocity,
    body_pose,
    door_angle,
    is_out_of_bounds,
    is_unstable,
    reset,
    step,
    step_checked,
    undo_where,
    with_agent_speed,
)
from home_mjx.physics.hand_control import HandCommands, apply_hand_commands, update_hands
from home_mjx.physics.mjx.overflow import Overflow
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.mujoco.mujoco_model import MujocoModel

if TYPE_CHECKING:
    from home_mjx.physics.mujoco.exported_template import ExportedTemplate
    from home_mjx.physics.mujoco.robot import robot_in_house

_EXPORTED = {"ExportedTemplate": "exported_template", "robot_in_house": "robot"}

__all__ = [
    "BodyScale",
    "ExportedTemplate",
    "HandCommands",
    "MujocoModel",
    "Overflow",
    "PhysicsConfig",
    "PhysicsSetup",
    "PhysicsState",
    "Template",
    "agent_contact",
    "agent_pose",
    "agent_velocity",
    "apply_hand_commands",
    "body_pose",
    "door_angle",
    "is_out_of_bounds",
    "is_unstable",
    "reset",
    "robot_in_house",
    "step",
    "step_checked",
    "undo_where",
    "update_hands",
    "with_agent_speed",
]


def __getattr__(name: str) -> Any:
    """Import and return `ExportedTemplate` or `robot_in_house` on access; they import the house compiler.

    Raises:
        AttributeError: The name is another one.
    """
    if name not in _EXPORTED:
        raise AttributeError(f"module 'home_mjx.physics' has no attribute {name!r}")
    return getattr(importlib.import_module(f"home_mjx.physics.mujoco.{_EXPORTED[name]}"), name)
