"""Boxes nearest to a line: against sampled points; both kernels, CUDA's compiled as C++, against XLA's operations."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from compiled_kernels import block_program, blocks_instead, nvrtc_ptx, shared_library

from home_mjx.audio_jax.geometry import nearest_boxes as module
from home_mjx.audio_jax.geometry.box_lengths import WITHOUT_EDGES, nearest_boxes_by_xla
from home_mjx.audio_jax.geometry.box_lengths import path_lengths as lengths_over
from home_mjx.audio_jax.geometry.nearest_boxes import nearest_boxes

INTS, FLOATS = "(int*)p[{}]", "(float*)p[{}]"
ARGUMENTS = ", ".join(
    kind.format(i) for i, kind in enumerate([FLOATS, INTS, INTS, FLOATS, INTS, FLOATS, INTS, INTS, INTS])
)


def random_boxes(rng, *shape):
    """Fields and owners of boxes in random poses; some without edges, some of objects 0 to 4."""
    turn = np.linalg.qr(rng.normal(size=(*shape, 3, 3)))[0]
    fields = rng.uniform(-4, 4, (*shape, 3)), turn.reshape(*shape, 9), rng.uniform(0.02, 0.8, (*shape, 3))
    owner = rng.choice([WITHOUT_EDGES, -1, -1, 0, 1, 2, 3, 4], shape)
    return jnp.float32(np.moveaxis(np.concatenate(fields, axis=-1), -1, -2)), jnp.int32(owner)


@pytest.fixture
def problem(rng):
    """Four environments in two houses, with the operands of `nearest_boxes`."""
    points = jnp.float32(rng.uniform(-4, 4, (2, 4, 3)))
    bodies = jnp.int32([[-1, -1], [0, 1], [2, 2], [-1, 3]])
    return *random_boxes(rng, 2, 300), jnp.int32([0, 1, 1, 0]), *random_boxes(rng, 4, 40), *points, bodies


AXES = (None, None, *[0] * 6)


def chosen(problem, count):
    """Boxes that `nearest_boxes` chooses in each environment."""
    return jax.vmap(lambda *given: nearest_boxes(*given, count), AXES)(*problem)


def chosen_by_xla(problem, count):
    *tables, sources, listeners, bodies = problem
    ends = jnp.concatenate([sources, listeners], axis=1)
    return jax.vmap(lambda *given: nearest_boxes_by_xla(*given, count=count), AXES[:-1])(*tables, ends, bodies)


def path_lengths(problem, env):
    """Lengths of the paths over all boxes in one environment; 99 if a box does not count."""
    fixed, fixed_owner, houses, moving, moving_owner, sources, listeners, bodies = problem
    fields = jnp.concatenate([fixed[houses[env]], moving[env]], axis=1)
    length = np.array(lengths_over(fields, sources[env], listeners[env]))
    owner = np.concatenate([fixed_owner[houses[env]], moving_owner[env]])
    return np.where((owner == WITHOUT_EDGES) | (np.isin(owner, bodies[env]) & (owner >= 0)), 99, length)


@pytest.mark.parametrize("choose", [chosen, chosen_by_xla])
def test_they_are_those_of_the_shortest_paths(problem, rng, choose):
    """Against paths over the nearest of many points in each box; excluded boxes are not chosen."""
    fixed, fixed_owner, houses, moving, moving_owner, sources, listeners, bodies = (np.asarray(x) for x in problem)
    nearest = np.asarray(choose(problem, 8))
    for env in range(4):
        fields = np.concatenate([fixed[houses[env]], moving[env]], axis=1)
        owner = np.concatenate([fixed_owner[houses[env]], moving_owner[env]])
        inside = rng.uniform(-1, 1, (4000, 1, 3)) * fields[12:].T
        points = fields[:3].T + np.einsum("pba,baw->pbw", inside, fields[3:12].T.reshape(-1, 3, 3))
        length = sum(np.linalg.norm(points - end, axis=-1) for end in (sources[env], listeners[env])).min(axis=0)
        length[(owner == WITHOUT_EDGES) | (np.isin(owner, bodies[env]) & (owner >= 0))] = np.inf
        assert np.isfinite(length[nearest[env]]).all()
        assert length[nearest[env]].max() < np.sort(length)[7] + 0.15


@pytest.mark.parametrize("count", [1, 24, pytest.param(340, marks=pytest.mark.slow)])
def test_the_kernel_chooses_what_xla_does(problem, tmp_path, monkeypatch, count):
    """Up to rounding: boxes on the straight line have equal lengths."""
    program = block_program([module.SOURCE], {}, "nearest_boxes", ARGUMENTS)
    library = shared_library(tmp_path, program)
    monkeypatch.setattr(module, "_ptx", lambda: "")
    wanted = chosen_by_xla(problem, count)
    monkeypatch.setattr(jax.ffi, "ffi_call", blocks_instead(lambda *_: library))
    *tables, sources, listeners, bodies = problem
    (got,) = module.launch_nearest(count, *tables, jnp.concatenate([sources, listeners], axis=1), bodies)
    for env in range(4):
        assert len(set(got[env].tolist())) == count
        length = path_lengths(problem, env)
        np.testing.assert_allclose(length[got[env]], length[wanted[env]], rtol=1e-5)


@pytest.mark.parametrize("count", [1, 5, 24, 256])
def test_the_cpu_kernel_chooses_what_xla_does(problem, count):
    """Up to rounding; from 256 results on, boxes that do not count fill the rest."""
    assert module.KERNEL.is_usable("cpu")
    got, wanted = np.asarray(chosen(problem, count)), np.asarray(chosen_by_xla(problem, count))
    for env in range(4):
        assert len(set(got[env].tolist())) == count
        length = path_lengths(problem, env)
        np.testing.assert_allclose(length[got[env]], length[wanted[env]], rtol=1e-5)


def test_few_boxes_that_count(rng):
    """Fewer than results, in a house with one box whose number is no multiple of the lanes: the others follow."""
    fixed, _ = random_boxes(rng, 1, 11)
    moving, _ = random_boxes(rng, 1, 2)
    owner = jnp.full((1, 11), WITHOUT_EDGES).at[0, 9].set(-1)
    ends = jnp.float32(rng.uniform(-4, 4, (2, 1, 3)))
    problem = fixed, owner, jnp.int32([0]), moving, jnp.int32([[0, 3]]), *ends, jnp.int32([[0, -1]])
    got = np.asarray(chosen(problem, 6))[0]
    assert set(got[:2].tolist()) == {9, 12}
    assert len(set(got.tolist())) == 6


def test_more_than_there_are_gives_all(problem):
    assert sorted(chosen(problem, 500)[0].tolist()) == list(range(340))


def test_nvrtc_compiles_it():
    """If it is here."""
    assert ".entry" in nvrtc_ptx(module.SOURCE, 90)
