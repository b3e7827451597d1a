"""Sizes that the fused step has in common on CPUs and GPUs; `cuda/base.cuh` repeats them, and a test compares."""

from home_mjx.physics.base.servo import FREE as FREE

AGENT_DOFS, BODY_DOFS, DOOR_DOFS = 3, 6, 1  # that contacts act on; an agent's yaw is on its own
LIMIT, FLOOR, STATIC = -1, -2, -3  # the second mobile of a contact with what does not move; static box c is STATIC - c
MOST_POINTS = 16  # of a pair of shapes
NEAR = 24  # static boxes that are kept near each mobile
POINTS_PER_MOBILE = 24  # contact points that there is room for
AGENT_COLUMNS, DOOR_COLUMNS, RAMP_COLUMNS = 8, 13, 8
