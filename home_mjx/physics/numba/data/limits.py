"""Sizes shared by the fused step on CPUs and GPUs; `cuda/base.cuh` repeats them, and a test compares both."""

from home_mjx.physics.base.servo import NOT_DRIVEN as NOT_DRIVEN
from home_mjx.physics.base.touch import FLOOR as FLOOR
from home_mjx.physics.base.touch import NOTHING
from home_mjx.physics.base.touch import STATIC as STATIC
from home_mjx.physics.numba.shapes.box_box import MAX_PAIR_POINTS as MAX_PAIR_POINTS

AGENT_DOFS, BODY_DOFS, DOOR_DOFS = 3, 6, 1  # DoFs that contacts act on; an agent's yaw is independent of contacts
JOINT_LIMIT = NOTHING  # code of a contact's second side if a door is at its joint limit
SLEEPING_BODY = -1_000_000  # code of a contact's second body m if that sleeps: SLEEPING_BODY - m
MAX_NEAR_BOXES = 24  # maximum number of listed static boxes per dynamic body
POINTS_PER_BODY = 24  # contact points per dynamic body that the buffer holds
AGENT_COLUMNS, DOOR_COLUMNS, RAMP_COLUMNS, SURFACE_COLUMNS = 8, 16, 8, 5
