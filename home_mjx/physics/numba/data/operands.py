"""What the compiled step is given and gives, in order: one list for CPUs, GPUs and their caller."""

# Shared by all environments: the houses', the agents' and the template's numbers.
COLLIDER_POS, COLLIDER_QUAT, COLLIDER_HALF, BODY_VALID, BODY_SIZE, BODY_MASS, BODY_INERTIA, BODY_SURFACE = range(8)
DOOR, RAMP, FLOOR, AGENT, NUMBERS = range(8, 13)
NUM_SHARED = 13
# Of each environment.
HOUSE, QPOS, QVEL, QACC, ACTION, HELD, GRIP, GOAL, SCALE = range(NUM_SHARED, 22)
# Results.
NEW_QPOS, NEW_QVEL, NEW_QACC, TOUCHED, LOST, PUSH, OTHER = range(7)
NUM_RESULTS = 7
