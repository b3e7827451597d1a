"""Eight small houses that differ, for streams of houses."""

import shutil
import time

import jax.numpy as jnp
import numpy as np
from tiny_dataset import edit_house, write_tiny_dataset

from home_mjx.bank.bank import HouseBank
from home_mjx.houses.stream import HouseStream

NUM_HOUSES, NUM_SLOTS = 8, 4


IDS = tuple(f"{i:032x}" for i in range(1, NUM_HOUSES + 1))


def write_streamed_houses(folder):
    """Houses that differ in where their table stands and in the colour of their box."""
    root = write_tiny_dataset(folder)
    for i, house_id in enumerate(IDS):
        if i:
            for folder in ("house", "room"):
                shutil.copytree(root / folder / IDS[0], root / folder / house_id)

        def change(house: dict, i: int = i, house_id: str = house_id):
            nodes = house["levels"][0]["nodes"]
            house["id"] = house_id
            nodes[2]["transform"][12] += 0.05 * i
            nodes[4]["materials"] = [{"name": "a", "diffuse": f"#{20 * i + 40:02x}8000"}] * 6

        edit_house(root, change, house_id)
    return root


def ids_of(bank: HouseBank) -> list[str]:
    return [bytes(row).rstrip(b"\0").decode() for row in np.asarray(bank.house_id)]


def run_until(stream: HouseStream, swaps: int, houses=()):
    end = time.monotonic() + 60
    while stream.num_swaps < swaps:
        assert time.monotonic() < end
        stream.advance(jnp.array(houses or [0], jnp.int32) if houses else jnp.zeros(0, jnp.int32))
        time.sleep(0.005)
