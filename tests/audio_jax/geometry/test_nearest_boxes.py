"""Boxes nearest to a line: against sampled points, and the CUDA kernel, compiled as C++, against XLA's operations."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from compiled_kernels import block_program, blocks_instead, shared_library

from home_mjx.audio_jax.geometry import nearest_boxes as module
from home_mjx.audio_jax.geometry.nearest_boxes import WITHOUT_EDGES, nearest_boxes
from home_mjx.core.native import nvrtc
from home_mjx.errors import BackendError

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


def chosen_by_xla(problem, count):
    axes = (None, None, *[0] * 6)
    return jax.vmap(lambda *given: nearest_boxes(*given, count), axes)(*problem)


def test_they_are_those_of_the_shortest_paths(problem, rng):
    """Against paths over the nearest of many points in each box; excluded boxes are not chosen."""
    fixed, fixed_owner, houses, moving, moving_owner, sources, listeners, bodies = (np.asarray(x) for x in problem)
    chosen = np.asarray(chosen_by_xla(problem, 8))
    for env in range(4):
        fields = np.concatenate([fixed[houses[env]], moving[env]], axis=1)
        owner = np.concatenate([fixed_owner[houses[env]], moving_owner[env]])
        inside = rng.uniform(-1, 1, (4000, 1, 3)) * fields[12:].T
        points = fields[:3].T + np.einsum("pba,baw->pbw", inside, fields[3:12].T.reshape(-1, 3, 3))
        length = sum(np.linalg.norm(points - end, axis=-1) for end in (sources[env], listeners[env])).min(axis=0)
        length[(owner == WITHOUT_EDGES) | (np.isin(owner, bodies[env]) & (owner >= 0))] = np.inf
        assert np.isfinite(length[chosen[env]]).all()
        assert length[chosen[env]].max() < np.sort(length)[7] + 0.15


@pytest.mark.parametrize("count", [1, 24, 340])
def test_the_kernel_chooses_what_xla_does(problem, tmp_path, monkeypatch, count):
    """Up to rounding: boxes on the straight line have equal lengths."""
    program = block_program([module.SOURCE], {}, "nearest_boxes", ARGUMENTS)
    library = shared_library(tmp_path, program)
    monkeypatch.setattr(module, "_ptx", lambda: "")
    wanted = chosen_by_xla(problem, count)
    monkeypatch.setattr(jax.ffi, "ffi_call", blocks_instead(lambda *_: library))
    *tables, sources, listeners, bodies = problem
    (got,) = module.launch_nearest(count, *tables, jnp.concatenate([sources, listeners], axis=1), bodies)
    fixed, fixed_owner, houses, moving, moving_owner, *_ = problem
    for env in range(4):
        assert len(set(got[env].tolist())) == count
        fields = jnp.concatenate([fixed[houses[env]], moving[env]], axis=1)
        length = np.array(module._path_lengths(fields, sources[env], listeners[env]))
        owner = np.concatenate([fixed_owner[houses[env]], moving_owner[env]])
        length[(owner == WITHOUT_EDGES) | (np.isin(owner, bodies[env]) & (owner >= 0))] = 99
        np.testing.assert_allclose(length[got[env]], length[wanted[env]], rtol=1e-5)


def test_more_than_there_are_gives_all(problem):
    assert sorted(chosen_by_xla(problem, 500)[0].tolist()) == list(range(340))


def test_nvrtc_compiles_it():
    """If it is here."""
    try:
        nvrtc.find_library()
    except BackendError:
        pytest.skip("there is no NVRTC here")
    assert ".entry" in nvrtc.compile_ptx(module.SOURCE, 90)
