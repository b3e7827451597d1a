"""Define a dataset: `boxes:N` opens N houses of two rooms with wooden crates at random places."""

from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import jax
import numpy as np

import home_mjx
from home_mjx.datasets import (
    Dataset,
    FileDigests,
    ReadOptions,
    RoomOutline,
    WallOpening,
    open_dataset,
    outline_house,
    register_dataset,
)
from home_mjx.schema import House, Material, Mesh, Metadata, ObjectNode

EDGE, NUM_CRATES = 0.4, 6  # [m]; per house
ROOMS = [  # (x, z) of the centre lines of walls [m]
    RoomOutline("Living_Room", [(0, 0), (5, 0), (5, 4), (0, 4)]),
    RoomOutline("Bedroom", [(5, 0), (9, 0), (9, 4), (5, 4)]),
]
DOORWAY = WallOpening((5, 1.5), (5, 2.5))
CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (0, 1) for z in (-0.5, 0.5)])  # y is up
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
FACES = QUADS[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)  # counter-clockwise, seen from outside


class BoxDataset(Dataset):
    """Dataset `boxes:N`; house i depends only on i."""

    categories: ClassVar = {"crate": ("ottoman", "ottoman", "otherprop")}  # own name -> (fine, coarse, NYU40)
    shares_root = True  # `boxes:3` and `boxes:12` have one root

    def __init__(self, text: str) -> None:
        super().__init__(root=Path(__file__).parent, name=f"boxes:{text}")
        self.count = int(text)

    @cached_property
    def house_ids(self) -> tuple[str, ...]:
        """Ids of all houses, in a fixed order."""
        return tuple(f"boxes-{i}" for i in range(self.count))

    @cached_property
    def metadata(self) -> Metadata:
        """Categories of the models by id."""
        return Metadata({"crate": self.model_info("crate", "crate")})

    def load_house(self, house_id: str, options: ReadOptions | None = None) -> House:
        """Return one house: rooms from outlines, and crates on the floor."""
        self.check_known(house_id)
        rng = np.random.default_rng(self.house_ids.index(house_id))
        house = outline_house(house_id, ROOMS, [DOORWAY])
        crates = [self._crate(len(ROOMS) + i, rng) for i in range(NUM_CRATES)]
        level = replace(house.levels[0], objects=tuple(crates))
        wood, zeros = Material("wood_1", diffuse=(0.6, 0.45, 0.3)), np.zeros(len(FACES), np.int32)
        mesh = Mesh(Path("crate"), EDGE * CORNERS, FACES, np.zeros((len(FACES), 3, 2)), zeros, zeros - 1, (wood,))
        return replace(house, levels=(level,), models={"crate": mesh})

    def _crate(self, index: int, rng: np.random.Generator) -> ObjectNode:
        pose = np.eye(4)
        pose[:3, 3] = rng.uniform(0.5, 8.5), 0.05, rng.uniform(0.5, 3.5)  # the floor's top is at 0.05 m
        return ObjectNode(f"0_{index}", index, f"crates[{index}]", None, "crate", "crate", pose)

    def inputs(self) -> FileDigests:
        """Return digests: all houses are compiled again if this file changes."""
        return FileDigests(self.root, lambda house_id: [Path(__file__)])


register_dataset("boxes", BoxDataset)

if __name__ == "__main__":
    home_mjx.use_compile_cache()
    print(f"{len(open_dataset('boxes:12').house_ids)} houses")
    env = home_mjx.make("PointNav-v0", "boxes:12", num_houses=3, sensors=("goal",), impl="kinematic", ctrl_dt=0.3)
    reset, step = jax.jit(jax.vmap(env.reset)), jax.jit(jax.vmap(env.step))
    states = reset(jax.random.split(jax.random.key(0), 8))
    for _ in range(20):  # walk straight ahead
        states = step(states, np.tile(np.array([1.0, 0.0, 0.0, 0.0], np.float32), (8, 1)))
    print("distance to the goal [m]:", states.metrics["distance"].round(2))
