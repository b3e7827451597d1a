"""What holds whatever agents do, for some steps in two houses; `make soak` goes on for as long as is wanted."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from handmade import Furniture, shoebox
from house_oracle import HouseOracle, energy
from invariants import Soak

from home_mjx.bank.bank import HouseBank

SOAK = Path(__file__).with_name("invariants.py")
RADIUS, HEIGHT = 0.2, 1.6


@pytest.fixture(scope="module")
def bank():
    """A room of 6 by 5 m with a cupboard that stands in the middle, and a crate."""
    return HouseBank.from_compiled(
        [shoebox(furniture=[Furniture((0.0, 0.0), (1.0, 1.0, 1.0)), Furniture((2.0, 0.0), mass=8.0)])]
    )


@pytest.fixture(scope="module")
def house(bank):
    square = np.array([[-3, -2.5], [3, -2.5], [3, 2.5], [-3, 2.5]])
    return HouseOracle.of(bank.physics, 0, np.stack([square[[0, 1, 2]], square[[0, 2, 3]]]))


def test_the_oracle_knows_walls_and_rooms(house):
    """Of the cupboard's sides and of walls; from beside it, through it, over it."""
    places = np.array([[0.0, 0, 0.8], [0.69, 0, 0.8], [0.71, 0, 0.8], [2.81, 0, 0.8], [2.79, 0, 0.8], [0.6, 0.6, 0.8]])
    depth = house.depth(places, RADIUS, HEIGHT).max(axis=-1)
    np.testing.assert_allclose(depth, [0.7, 0.01, -0.01, 0.01, -0.01, 0.2 - 0.1 * 2**0.5], atol=1e-6)
    ways = [([-1, 0, 0.5], [1, 0, 0.5]), ([-1, 0, 1.1], [1, 0, 1.1]), ([-1, 0, 0.5], [-0.51, 0, 0.5])]
    ways += [([-1, 0, 0.5], [-0.4, 0, 0.5]), ([2.9, 0, 1], [3.3, 0, 1]), ([-1, 0.6, 0.5], [1, 0.6, 0.5])]
    begin, end = np.moveaxis(np.array(ways, float), 1, 0)
    assert house.passed(begin, end).tolist() == [True, False, False, True, True, False]
    assert house.outdoors(np.array([[0, 0, 0], [3.2, 0, 0], [3.4, 0, 0], [3.25, 2.75, 0]])).tolist() == [0, 0, 1, 1]


def test_the_oracle_knows_energy(bank):
    """A crate of 8 kg, 2 m above the floor, at 3 m/s, turning about its upright axis."""
    size = np.asarray(bank.physics.body_size[0, 0], float)
    pos, speed, spin = (np.zeros((1, bank.spec.num_bodies, 3)) for _ in range(3))
    pos[0, 0, 2], speed[0, 0, 0], spin[0, 0, 2] = 2, 3, 4
    turning = 0.5 * 8 / 3 * (size[0] ** 2 + size[1] ** 2) * 16
    np.testing.assert_allclose(energy(bank.physics, 0, pos, speed, spin, 0.0), [8 * 9.81 * 2 + 36 + turning], rtol=1e-5)


@pytest.fixture(scope="module")
def soak(generated_bank):
    return Soak(generated_bank, None, num_envs=12)


def test_everything_holds(soak):
    assert soak.run(30) == 30
    assert soak.faults == []
    assert soak.broken >= 4


def test_what_does_not_hold_is_told(soak):
    """The same steps, looked at as if agents and things had been elsewhere."""
    now = {name: x.copy() for name, x in soak.now.items()}
    for e, house in enumerate(now["house"]):
        wall = soak.houses[house]
        at = np.argmax(wall.half[:, 2])
        now["agents"][e, 0] = wall.pos[at]
        now["bodies"][e, :, 2] -= 3
        now["speed"][e, :, 0] = 7.0
    kept, soak.faults = soak.faults, []
    soak.look(soak.now, now)
    found, soak.faults = {fault["what"] for fault in soak.faults}, kept
    wanted = {"an agent is in a wall", "an agent in something counts no contact", "an agent went through a wall"}
    assert found >= wanted | {"a thing is under the floor", "a thing is too fast"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mode", "envs", "steps"),
    [
        ("plain", 64, 200),
        ("x64", 8, 40),
        ("debug_nans", 8, 40),
        ("no_jit", 1, 2),
    ],
)
def test_everything_holds_in_each_mode(mode, envs, steps):
    """In generated houses, with the plans of their floors."""
    command = [sys.executable, SOAK, "--mode", mode, "--houses", 3, "--envs", envs, "--steps", steps]
    environment = {**os.environ, "PYTHONPATH": str(SOAK.parents[2])}
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, timeout=1500, env=environment, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    record = json.loads(done.stdout.splitlines()[-1])
    assert (record["env_steps"], record["faults"]) == (envs * steps, 0)
