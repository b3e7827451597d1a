"""The CUDA C of the fused step without a GPU: compiled as C++ for the CPU it steps as `native` does."""

import ctypes
import re
from pathlib import Path

import numpy as np
import pytest
from c_oracle import Boxes, Oracle
from compiled_kernels import shared_library
from heaps import AGENTS, BODIES, DOORS, RAMPS, heap
from odd_numbers import garbled
from sanitized import Program

from home_mjx.physics import fused
from home_mjx.physics.base import doors
from home_mjx.physics.base.servo import NOT_DRIVEN
from home_mjx.physics.base.state import FLOOR, STATIC
from home_mjx.physics.fused import (
    CONTACT_WORDS,
    NUM_COUNTS,
    PAIRS_PER_BODY,
    SCRATCH_WORDS,
    SHARED_CONTACTS,
    SMALL_ISLAND,
    SOURCES,
)
from home_mjx.physics.numba import params
from home_mjx.physics.numba.box_box import MAX_PAIR_POINTS
from home_mjx.physics.numba.params import HELD, StepParams, reference_surfaces

WHOLE = 3, 13, 18, 22, 23  # operands of whole numbers
CHECKED = 11, 12  # agents and options
CALLS = 60  # with garbage
SHIM = Path(__file__).parents[2] / "helpers" / "physics_shim.h"
MAIN = """
extern "C" void run(void** p) {
#define IN(type, i) (const type*)p[i]
  step_physics(IN(float, 0), IN(float, 1), IN(float, 2), IN(int, 3), IN(float, 4), IN(float, 5), IN(float, 6),
               IN(float, 7), IN(float, 8), IN(float, 9), IN(float, 10), IN(float, 11), IN(float, 12), IN(int, 13),
               IN(float, 14), IN(float, 15), IN(float, 16), IN(float, 17), IN(int, 18), IN(float, 19), IN(float, 20),
               IN(float, 21), IN(int, 22), IN(int, 23), (float*)p[24], (float*)p[25], (float*)p[26], (int*)p[27],
               (int*)p[28], (float*)p[29], (int*)p[30], (char*)p[31]);
}
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    text = f'#include "{SHIM}"\n' + "".join(path.read_text() for path in SOURCES) + MAIN
    return shared_library(tmp_path_factory.mktemp("step"), text, "-fno-strict-aliasing")


def in_single(oracle: Oracle) -> None:
    """Rounds the house's numbers to what the kernel is given."""

    def single(x):
        return np.asarray(x, np.float32).astype(float)

    oracle.static, oracle.bodies = (Boxes(*map(single, boxes)) for boxes in (oracle.static, oracle.bodies))
    oracle.mass, oracle.inertia = single(oracle.mass), single(oracle.inertia)
    oracle.numbers = type(oracle.numbers)(*single(oracle.numbers).tolist())
    oracle.surfaces = single(reference_surfaces(oracle.surfaces)) / reference_surfaces(np.ones(5))
    oracle.table, oracle.door_rows = single(oracle.table), single(oracle.door_rows)


def step(library, oracle: Oracle, qpos, qvel, action, substeps: int, scale=(1.0, 1.0)):
    inputs, outputs = operands(oracle, qpos, qvel, action, substeps, scale)
    pointers = [x.ctypes.data for x in inputs + outputs]
    library.run((ctypes.c_void_p * len(pointers))(*pointers))
    return outputs


def operands(oracle: Oracle, qpos, qvel, action, substeps: int, scale=(1.0, 1.0)):
    """What the kernel reads, and where it writes."""
    agents, bodies, static = oracle.agents, len(oracle.mass), len(oracle.static.pos)
    numbers, doors = oracle.numbers._replace(substeps=float(substeps)), oracle.door_rows
    valid, house = np.ones(bodies), np.zeros(1)
    num_doors, trays = len(oracle.doors.mass), len(oracle.doors.tray)
    sizes = np.array([1, 1, static, bodies, agents, num_doors, len(oracle.ramps), 0, trays])
    inputs = [*oracle.static, valid, oracle.bodies.half, oracle.mass, oracle.inertia]
    inputs += [reference_surfaces(oracle.surfaces), doors, oracle.ramps, np.zeros(1)]
    inputs += [oracle.table, numbers, house, qpos, qvel, np.zeros(len(qvel)), action, *oracle.driven]
    inputs += [np.array(scale), np.zeros(1), sizes]
    inputs = [np.ascontiguousarray(x, np.int32 if i in WHOLE else np.float32) for i, x in enumerate(inputs)]
    mobiles = agents + bodies + num_doors
    outputs = [np.zeros(len(x), np.float32) for x in (qpos, qvel, qvel)]
    outputs += [np.zeros(agents, np.int32), np.zeros(2, np.int32), np.zeros((mobiles, 4), np.float32)]
    words = SCRATCH_WORDS * mobiles + fused._newton_words(mobiles)
    return inputs, [*outputs, np.zeros(mobiles, np.int32), np.zeros(words)]  # here its numbers have 64 bits


def test_garbage_in_every_array_stays_within_the_arrays(library, tmp_path):
    """But in the numbers of the options, which are checked, and in what is held, which is clipped; see `fused.py`."""
    source = Path(library._name).with_name("main.cpp").read_text()
    program, rng = Program(tmp_path, source, "run(p)"), np.random.default_rng(17)
    for number in range(CALLS):
        oracle, *state = heap(rng, trays=number % 2 == 1)
        in_single(oracle)
        oracle.drive(rng)
        oracle.ramps = RAMPS.astype(np.float32).astype(float)
        inputs, outputs = operands(oracle, *state, 3)
        kept = {i: inputs[i] for i in (*CHECKED, len(inputs) - 2, len(inputs) - 1)}
        inputs = [np.asarray(x) for x in garbled(f"step:{number}", tuple(inputs))[0]]
        inputs[HELD] = np.clip(inputs[HELD], -1, len(oracle.mass) - 1)
        program.add([kept.get(i, x) for i, x in enumerate(inputs)] + outputs)
    program.run()


@pytest.mark.parametrize("substeps", [1, 5])
def test_a_heap_moves_as_on_a_cpu(library, substeps):
    rng = np.random.default_rng(11)
    for number in range(20):
        oracle, *state = heap(rng, trays=number % 2 == 1)
        in_single(oracle)
        oracle.drive(rng)
        oracle.ramps = RAMPS.astype(np.float32).astype(float)
        qpos, qvel, action = (np.asarray(x, np.float32).astype(float) for x in state)
        truth = oracle.fused(qpos, qvel, action, substeps)
        found = step(library, oracle, qpos, qvel, action, substeps)
        for value, want in zip(found[:3], truth[:3], strict=True):
            np.testing.assert_allclose(value, want, atol=3e-7 * np.abs(want).max())
        assert found[4].tolist() == truth[4].tolist()
        np.testing.assert_allclose(found[5], oracle.push, atol=3e-7 * np.abs(oracle.push).max())
        assert found[6].tolist() == oracle.other.tolist()


def test_scaled_bodies_move_as_those_of_a_house_that_has_them_so(library):
    rng, friction, heavier = np.random.default_rng(13), 0.5, 2.0  # exact in any type
    for _ in range(5):
        oracle, *state = heap(rng)
        in_single(oracle)
        plain, scaled = (step(library, oracle, *state, 5, scale) for scale in ((1.0, 1.0), (friction, heavier)))
        oracle.mass, oracle.inertia = oracle.mass * heavier, oracle.inertia * heavier
        oracle.surfaces = oracle.surfaces * [friction, 1, 1, 1, 1]
        own = step(library, oracle, *state, 5)
        for value, other in zip(scaled, own, strict=True):
            np.testing.assert_array_equal(value, other)
        assert np.abs(scaled[0] - plain[0]).max() > 1e-4


def test_what_sleeps_wakes_as_on_a_cpu(library):
    """Half of the bodies and doors sleep; agents and the others run into some of them."""
    rng, woken, asleep = np.random.default_rng(12), 0, 0
    for number in range(20):
        substeps = 1 + 4 * (number % 2)
        oracle, *state = heap(rng, trays=number % 4 > 1)
        in_single(oracle)
        oracle.numbers = oracle.numbers._replace(sleep=1.0)
        qpos, qvel, action = (np.asarray(x, np.float32).astype(float) for x in state)
        still = rng.uniform(size=BODIES) < 0.5
        qvel[4 * AGENTS : 4 * AGENTS + 6 * BODIES].reshape(-1, 6)[still] = 0
        qvel[4 * AGENTS + 6 * BODIES :][rng.uniform(size=DOORS) < 0.5] = 0
        truth = oracle.fused(qpos, qvel, action, substeps)
        found = step(library, oracle, qpos, qvel, action, substeps)
        for value, want in zip(found[:3], truth[:3], strict=True):
            np.testing.assert_allclose(value, want, atol=3e-7 * np.abs(want).max())
        assert found[6].tolist() == oracle.other.tolist()
        moves = truth[1][4 * AGENTS : 4 * AGENTS + 6 * BODIES].reshape(-1, 6).any(axis=1)
        woken, asleep = woken + (moves & still).sum(), asleep + (~moves & still).sum()
    assert woken > 5
    assert asleep > 5


def test_sizes_and_numbers_are_those_of_the_other_step():
    text = SOURCES[0].read_text()
    found = {name: int(value) for name, value in re.findall(r"(\w+) = (-?\d+)[,;]", text)}
    columns = ("AGENT_COLUMNS", "DOOR_COLUMNS", "RAMP_COLUMNS", "SURFACE_COLUMNS", "TRAY_BOXES", "TRAY_ROWS")
    sizes = ("JOINT_LIMIT", "SLEEPING_BODY", "MAX_NEAR_BOXES", "POINTS_PER_BODY", *columns)
    own = {name: getattr(params, name, None) or getattr(doors, name) for name in sizes}
    own |= {"FLOOR": FLOOR, "STATIC": STATIC, "NOT_DRIVEN": NOT_DRIVEN, "MAX_PAIR_POINTS": MAX_PAIR_POINTS}
    own |= {
        "CONTACT_WORDS": CONTACT_WORDS,
        "SMALL_ISLAND": SMALL_ISLAND,
        "PAIRS_PER_BODY": PAIRS_PER_BODY,
        "NUM_COUNTS": NUM_COUNTS,
        "SHARED_CONTACTS": SHARED_CONTACTS,
        "NUM_NUMBERS": len(StepParams._fields),
    }
    assert {name: found[name] for name in own} == own
    record = re.search(r"struct Numbers \{\s*real ([^;]*);", text)
    assert record is not None
    assert tuple(re.split(r",\s*", record[1])) == StepParams._fields
