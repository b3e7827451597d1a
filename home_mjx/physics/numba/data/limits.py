"""Sizes that the fused step has in common on CPUs and GPUs; `cuda/base.cuh` repeats them, and a test compares."""

from home_mjx.physics.base.servo import FREE as FREE
from home_mjx.physics.base.touch import FLOOR as FLOOR
from home_mjx.physics.base.touch import NOTHING
from home_mjx.physics.base.touch import STATIC as STATIC
from home_mjx.physics.numba.shapes.box_box import MOST_POINTS as MOST_POINTS

AGENT_DOFS, BODY_DOFS, DOOR_DOFS = 3, 6, 1  # that contacts act on; an agent's yaw is on its own
LIMIT = NOTHING  # the second mobile of a door at the end of its way
SLEEPER = -1_000_000  # of a contact with mobile m that sleeps: SLEEPER - m
NEAR = 24  # static boxes that are kept near each mobile
POINTS_PER_MOBILE = 24  # contact points that there is room for
AGENT_COLUMNS, DOOR_COLUMNS, RAMP_COLUMNS, SURFACE_COLUMNS = 8, 16, 8, 5
