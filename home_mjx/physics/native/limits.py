"""Sizes that the fused step has in common on CPUs and GPUs; `cuda/base.cuh` repeats them, and a test compares."""

AGENT_DOFS, BODY_DOFS = 3, 6  # that contacts act on; an agent's yaw is on its own
STATIC, FLOOR = -1, -2  # the second mobile of a contact with what does not move
MOST_POINTS = 16  # of a pair of shapes
NEAR = 24  # static boxes that are kept near each mobile
POINTS_PER_MOBILE = 24  # contact points that there is room for
