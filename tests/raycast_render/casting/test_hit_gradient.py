"""Gradients of t, u and v against finite differences in float64, and that ids have none."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from soup import brute_force, f32, random_rays, random_soup

from home_mjx.raycast_render.casting.cast import cast, occluded

N = 2000


@pytest.fixture(scope="module")
def case():
    soup = random_soup(np.random.default_rng(3))
    return soup, soup.scene(), *random_rays(np.random.default_rng(3), N)


def truth(soup, origin, direction, column):
    """t, u and v of given triangles (columns), wherever the rays pass their planes."""
    world = soup.world_triangles()[0][column]
    edge_1, edge_2, normal = world[:, 1] - world[:, 0], world[:, 2] - world[:, 0], None
    normal = np.cross(edge_1, edge_2)
    t = np.sum((world[:, 0] - origin) * normal, axis=1) / np.sum(direction * normal, axis=1)
    at = origin + t[:, None] * direction - world[:, 0]
    area = np.sum(normal * normal, axis=1)
    u = np.sum(np.cross(at, edge_2) * normal, axis=1) / area
    v = np.sum(np.cross(edge_1, at) * normal, axis=1) / area
    return np.stack([t, u, v])


def test_gradients_equal_finite_differences(case):
    soup, scene, origin, direction = case
    found = brute_force(soup, origin, direction)
    _, instance, *_ = soup.world_triangles()
    column = found.t.argmin(axis=1)
    moves = np.array([p.moves for p in soup.placed])[instance[column]]
    rng = np.random.default_rng(0)
    tangents = [rng.normal(size=(N, 3)), rng.normal(size=(N, 3)), rng.normal(size=scene.moving.pose.shape)]

    def hits(origin, direction, pose):
        hit = cast(scene.replace(moving=scene.moving.replace(pose=pose)), origin, direction, mask=7)
        return jnp.stack([jnp.where(hit.instance < 0, 0, hit.t), hit.u, hit.v])

    primal = f32(origin), f32(direction), scene.moving.pose
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        _, slope = jax.jit(lambda p, t: jax.jvp(hits, p, t))(primal, tuple(f32(x) for x in tangents))
    assert not np.asarray(slope)[:, ~np.isfinite(found.t).any(axis=1)].any(), "misses have no gradient"

    def shifted(step):
        for number, slot in [(i, i - (len(moves) - moves.sum())) for i in np.flatnonzero(moves)]:
            soup.placed[number].pose = poses[number] + step * tangents[2][slot]
        return truth(soup, origin + step * tangents[0], direction + step * tangents[1], column)

    moves = np.array([p.moves for p in soup.placed])
    poses = [p.pose.astype(np.float32).astype(float) for p in soup.placed]
    # World triangles round poses to float32, so the step must be large and the difference central.
    expected = (shifted(1e-2) - shifted(-1e-2)) / 2e-2
    shifted(0)
    steep = np.abs(expected).max(axis=0) < 30
    clear = np.isfinite(found.t.min(axis=1)) & ~found.doubtful & steep
    assert clear.mean() > 0.3
    np.testing.assert_allclose(np.asarray(slope)[:, clear], expected[:, clear], rtol=0.05, atol=0.1)


def test_reverse_mode_equals_forward_mode(case):
    _, scene, origin, direction = case

    def mean(origin, direction, pose):
        hit = cast(scene.replace(moving=scene.moving.replace(pose=pose)), origin, direction, mask=7)
        return jnp.where(hit.instance < 0, 0, hit.t * 0.1 + hit.u - hit.v).sum()

    args = f32(origin), f32(direction), scene.moving.pose
    gradient = jax.jit(jax.grad(mean, argnums=(0, 1, 2)))(*args)
    tangent = tuple(f32(np.random.default_rng(i).normal(size=x.shape)) for i, x in enumerate(args))
    _, slope = jax.jit(lambda p, t: jax.jvp(mean, p, t))(args, tangent)
    dot = sum(jnp.vdot(g, t) for g, t in zip(gradient, tangent, strict=True))
    np.testing.assert_allclose(dot, slope, rtol=1e-3)
    assert float(jnp.abs(gradient[2]).max()) > 0, "moving poses have a gradient"


def test_gradient_under_vmap_equals_a_loop(case):
    _, scene, origin, direction = case
    slope = jax.grad(lambda o, d: jnp.where(cast(scene, o, d, mask=7).instance < 0, 0, cast(scene, o, d, mask=7).t))
    many = jax.jit(jax.vmap(slope))(f32(origin[:16]), f32(direction[:16]))
    one = jax.jit(slope)
    for i in range(16):
        np.testing.assert_array_equal(many[i], one(f32(origin[i]), f32(direction[i])))


def test_visibility_has_no_gradient(case):
    _, scene, origin, direction = case
    hidden = lambda o: jnp.sum(occluded(scene, o, f32(direction), mask=7).astype(jnp.float32))  # noqa: E731
    assert not np.asarray(jax.jit(jax.grad(hidden))(f32(origin))).any()
