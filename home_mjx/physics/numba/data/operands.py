"""Operands and results of the compiled step, in order: one list for CPU and GPU kernels and their caller."""

# Shared by all environments: arrays of houses, agents and template parameters.
COLLIDER_POS, COLLIDER_QUAT, COLLIDER_HALF, BODY_VALID, BODY_SIZE, BODY_MASS, BODY_INERTIA, BODY_SURFACE = range(8)
DOOR, RAMP, FLOOR, AGENT, PARAMS = range(8, 13)
NUM_SHARED = 13
# One row per environment.
HOUSE, QPOS, QVEL, QACC, ACTION, HELD, GRIP, GOAL, SCALE = range(NUM_SHARED, 22)
# Results.
NEW_QPOS, NEW_QVEL, NEW_QACC, NUM_AGENT_CONTACTS, OVERFLOW, CONTACT_IMPULSE, CONTACT_PARTNER = range(7)
NUM_RESULTS = 7
