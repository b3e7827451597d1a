"""Image sources against brute force and the lattice of a box."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.geometry.image_sources import Mirrors, find_image_sources, select_nearest_mirrors
from home_mjx.audio_jax.propagation.image_source_paths import path_names


def mirrors(center, normal, u, v) -> Mirrors:
    center, normal, u, v = (np.asarray(x, np.float32) for x in (center, normal, u, v))
    return Mirrors(*map(jnp.asarray, (center, normal, u, v)), jnp.ones(len(center), bool))


def box(size) -> Mirrors:
    """The six sides of a room around the origin."""
    half = np.array(size) / 2
    normal = np.concatenate([np.eye(3), -np.eye(3)])
    axis = np.arange(6) % 3
    u, v = (np.eye(3)[(axis + i) % 3] * half[(axis + i) % 3][:, None] for i in (1, 2))
    return mirrors(-normal * half[axis][:, None], normal, u, v)


def scattered(rng, count=10) -> Mirrors:
    """Rectangles of any direction, as in a room full of furniture."""
    turn = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    size = rng.uniform(0.5, 3.0, (count, 2, 1))
    center = rng.uniform(-3, 3, (count, 3))
    inward = np.sign(-np.sum(turn[:, 0] * center, axis=1))[:, None]
    return mirrors(center, turn[:, 0] * inward, turn[:, 1] * size[:, 0], turn[:, 2] * size[:, 1])


def brute_force(m: Mirrors, source, listener, order) -> list[tuple[float, np.ndarray]]:
    """Lengths and reflection points, from the listener: one sequence after the other, in float64, by reflection
    of directions: a ray is sent from the listener to the last image and followed mirror by mirror."""
    c, n, u, v = (np.asarray(x, float) for x in (m.center, m.normal, m.u, m.v))
    found = []
    for row in itertools.product(range(len(c)), repeat=order):
        image, facing = np.array(source, float), True
        for k in row:
            facing &= bool((image - c[k]) @ n[k] > 0)
            image = image - 2 * ((image - c[k]) @ n[k]) * n[k]
        total = np.linalg.norm(image - listener)
        at, way, left, points = np.array(listener, float), (image - listener) / total, total, []
        for k in reversed(row):
            speed = way @ n[k]
            t = ((c[k] - at) @ n[k]) / speed if speed < 0 else -1.0
            at = at + t * way
            local = at - c[k]
            inside = abs(local @ u[k]) <= u[k] @ u[k] and abs(local @ v[k]) <= v[k] @ v[k]
            facing &= bool(t > 0) and bool(inside)
            left -= t
            way = way - 2 * (way @ n[k]) * n[k]
            points.append(at)
        if facing and left > 0:
            assert np.allclose(at + left * way, source, atol=1e-6)
            found.append((total, np.array(points)))
    return found


find = jax.jit(find_image_sources, static_argnames="max_order")


@pytest.mark.parametrize(("highest", "count"), [(1, 6), (2, 24), (3, 62)])
def test_a_box_has_the_images_of_its_lattice(highest, count):
    size, source, listener = np.array([6, 5, 3.0]), np.array([-1.3, 0.7, 0.2]), np.array([1.4, -1.1, 0.5])
    found = find(box(size), jnp.float32(source), jnp.float32(listener), max_order=highest)
    lengths = np.sort(np.asarray(found.length)[np.isfinite(found.length)])
    grid = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 3), axis=-1).reshape(-1, 3)
    order = abs(grid).sum(axis=1)
    image = grid * size + np.where(grid % 2, -1, 1) * source
    expected = np.sort(np.linalg.norm(image - listener, axis=1)[(order > 0) & (order <= highest)])
    assert len(expected) == count
    np.testing.assert_allclose(lengths, expected, rtol=1e-5)


@pytest.mark.parametrize("seed", range(1, 4))
@pytest.mark.parametrize("order", [1, 2])
def test_any_rectangles_as_by_brute_force(seed, order):
    rng = np.random.default_rng(seed)
    m = scattered(rng)
    total = 0
    for _ in range(10):
        source, listener = rng.uniform(-1, 1, (2, 3))
        expected = sorted(brute_force(m, source, listener, order), key=lambda x: x[0])
        found = find(m, jnp.float32(source), jnp.float32(listener), max_order=2)
        chosen = np.flatnonzero(np.isfinite(found.length) & (np.asarray(found.order) == order))
        chosen = chosen[np.argsort(np.asarray(found.length)[chosen])]
        assert len(chosen) == len(expected)
        for i, (length, points) in zip(chosen, expected, strict=True):
            assert float(found.length[i]) == pytest.approx(length, rel=1e-4)
            np.testing.assert_allclose(found.point[i, :order], points, atol=2e-3)
        total += len(expected)
    assert total > 0


def test_the_mirrors_that_are_kept_are_the_nearest():
    """Those over which the way is shortest, in a long room: not its far end."""
    room = box((20.0, 4.0, 3.0))
    kept = select_nearest_mirrors(room, jnp.float32([-8, 0, 0]), jnp.float32([-7, 1, 0.2]), 5)
    assert 10.0 not in np.asarray(kept.center)[:, 0]
    assert np.all(kept.valid)
    behind = select_nearest_mirrors(room, jnp.float32([30, 0, 0]), jnp.float32([31, 0, 0]), 6)
    assert int(behind.valid.sum()) == 5  # the back of the near end says nothing


def test_names_stay_while_source_and_listener_move():
    """Each of the 24 reflections in a box has a name of its own, the same after both have moved by 0.1 m."""
    room = box((4.0, 5.0, 2.7))
    places = jnp.array([[0.3, 1.2, 0.2], [-1.1, -0.7, 0.4]])
    found = [find_image_sources(room, *(places + step), 2) for step in (0.0, 0.1)]
    there = [np.isfinite(np.asarray(f.length)) for f in found]
    before, after = (np.asarray(path_names(f)) for f in found)
    assert there[0].sum() == 24
    assert len(set(before[there[0]])) == 24
    same = there[0] & there[1]
    np.testing.assert_array_equal(before[same], after[same])
