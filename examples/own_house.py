"""Build a house from outlines of rooms: write, validate and compile it, walk in it and draw it."""

import tempfile
from pathlib import Path

import jax
import numpy as np

import home_mjx
from home_mjx.datasets import (
    RoomOutline,
    WallOpening,
    open_dataset,
    outline_house,
    validate_house,
    write_house,
    write_library,
)
from home_mjx.schema import BoxNode
from home_mjx.tasks import add_expert
from home_mjx.viewer.pictures import TopView, write_png

rooms = [  # (x, z) of the centre lines of walls [m]
    RoomOutline("Living_Room", [(0, 0), (5, 0), (5, 4), (0, 4)]),
    RoomOutline("Bedroom", [(5, 0), (8, 0), (8, 4), (5, 4)]),
]
openings = [
    WallOpening((5, 1.5), (5, 2.5)),  # a doorway between the two rooms
    WallOpening((1, 0), (3, 0), low=0.9, high=2.1),  # a window
]
place = np.eye(4)
place[:3, 3] = 2, 0.05 + 0.375, 2.5  # centre of a table; the top of the floor is at 0.05 m
table = BoxNode(id="", index=0, path="", bbox=None, dimensions=np.array([1.2, 0.75, 0.7]), transform=place)

root = Path(tempfile.mkdtemp(prefix="home_mjx_house_"))
write_library(root, [], {})  # no models and no textures
write_house(root, outline_house("cabin", rooms, openings, [table]))
assert validate_house(open_dataset(root), "cabin") == ()

home_mjx.use_compile_cache()
env = add_expert(home_mjx.make("PointNav-v0", root, sensors=("goal",), impl="kinematic", ctrl_dt=0.3))
state, step = jax.jit(env.reset)(jax.random.key(0)), jax.jit(env.step)
path = []
for _ in range(60):
    state = step(state, state.obs["expert"])  # follow the shortest path
    path.append(np.asarray(env.core.snapshot(env.params, state).pose.pos[0]))
    if state.done:
        break
snapshot = env.core.snapshot(env.params, state)
goal = np.asarray(env.bank.navigation.goal[0, int(state.task.goal)])
write_png(root / "path.png", TopView(env.bank, snapshot.scene).draw_path(np.stack(path), goal, size=512))
print(f"{float(state.metrics['distance']):.2f} m from the goal after {len(path)} steps; see {root / 'path.png'}")
