"""Sound around edges of boxes, without any house: levels against exact solutions, and continuity of walks."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.options import Omni
from home_mjx.audio_jax.geometry.edge_paths import BarrierBoxes, find_edge_paths
from home_mjx.audio_jax.propagation.diffraction import assemble_paths
from home_mjx.audio_jax.propagation.paths import StraightLine, air_attenuation
from home_mjx.geometry.diffraction_edges import find_exposed_edges
from home_mjx.schema.compiled import BANDS

CONFIG = AudioConfig(receiver=Omni())
AIR = air_attenuation(CONFIG)
SPACE = np.array([[-50.0, 50.0]])  # [m], from floor to ceiling


def boxes(*low_high, yaw=0.0) -> BarrierBoxes:
    """Boxes given by their corners, turned about the origin; of their edges those that stand out."""
    low, high = (np.array(x, float) for x in zip(*low_high, strict=True))
    turn = np.array([[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    count = len(low)
    return BarrierBoxes(
        jnp.asarray((low + high) / 2 @ turn, jnp.float32),
        jnp.asarray(np.tile(turn, (count, 1, 1)), jnp.float32),
        jnp.asarray((high - low) / 2, jnp.float32),
        jnp.asarray(find_exposed_edges(low / 2 + high / 2, np.tile(np.eye(3), (count, 1, 1)), (high - low) / 2, SPACE)),
        jnp.full(count, -1),
    )


def blocked(obstacles: BarrierBoxes, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Whether segments meet any box: slabs, in float64."""
    start, end = np.broadcast_arrays(np.asarray(start, float), np.asarray(end, float))
    out = np.zeros(start.shape[:-1], bool)
    for center, axis, half in zip(
        *(np.asarray(x, float) for x in (obstacles.center, obstacles.axis, obstacles.half)), strict=True
    ):
        a, b = (start - center) @ axis.T, (end - center) @ axis.T
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.stack([(-half - a) / (b - a), (half - a) / (b - a)])
        inside = (abs(a) < half) | (a != b)
        enter, leave = np.nanmax(t.min(0), axis=-1), np.nanmin(t.max(0), axis=-1)
        out |= inside.all(-1) & (np.maximum(enter, 0) < np.minimum(leave, 1) - 1e-9)
    return out


@jax.jit
def render(straight, found, heard, ears):
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return assemble_paths(straight, found, heard, ears, CONFIG)


find = jax.jit(find_edge_paths)


def level(obstacles: BarrierBoxes, source, listener, within=False) -> np.ndarray:
    """Energy per octave re the free field [dB], air left out; `within`: by furniture, no partition."""
    source, listener = np.asarray(source, float), np.asarray(listener, float)
    found = find(obstacles, jnp.float32(source), jnp.float32(listener))
    there = np.isfinite(found.finite_edge_detour)
    heard = (
        there
        & ~blocked(obstacles, source, found.source_side_point)
        & ~blocked(obstacles, listener, found.listener_side_point)
    )
    clear = ~blocked(obstacles, source, listener)
    distance = np.linalg.norm(source - listener)
    nothing = jnp.full(len(BANDS), 1.0 if clear else 0.0)
    straight = StraightLine(
        jnp.float32(distance),
        jnp.float32((source - listener) / distance),
        nothing,
        jnp.ones(len(BANDS)),
        jnp.asarray(clear | within),
        jnp.asarray(clear),
        jnp.asarray(False),
    )
    paths = render(straight, found, jnp.asarray(heard), jnp.float32(listener))
    length = np.asarray(paths.distance, float)[:, None]
    energy = np.asarray(paths.gain, float) ** 2 * np.exp(AIR * length)
    return 10 * np.log10(np.sum(energy, axis=0) * distance**2)


def on_circle(angle, radius=1.5, height=0.0) -> np.ndarray:
    """A place around the z axis; angles [degrees] from the side of the screen that faces the source."""
    a = np.radians(angle)
    return np.array([-radius * np.sin(a), -radius * np.cos(a), height])


def screen(thickness=0.002) -> BarrierBoxes:
    return boxes(([-thickness / 2, -30, -30], [thickness / 2, 0, 30]))


@pytest.mark.parametrize(("turn", "expected"), [(0.2, -5.2), (15, -9.2), (30, -12.5), (60, -17.2)])
def test_the_edge_of_a_screen(turn, expected):
    """Source 60 degrees from the screen, both 1.5 m away, so many degrees into the shadow, 1 kHz octave."""
    assert level(screen(), on_circle(60), on_circle(240 + turn))[3] == pytest.approx(expected, abs=0.5)


@pytest.mark.parametrize("thickness", [0.002, 0.1, 0.3])
def test_a_walk_across_the_shadow_boundary(thickness):
    """Steps of 2.5 cm from free sight to deep shadow: no step of 5 cm changes any octave by more than 1.5 dB."""
    angle = 240 + np.arange(-30, 60, np.degrees(0.025 / 1.5))
    levels = np.array([level(screen(thickness), on_circle(60), on_circle(a)) for a in angle])
    change = np.abs(levels[2:] - levels[:-2]).max(axis=0)
    assert np.all(change[:6] < 1.5)
    assert change[6] < 1.7  # the exact solution's own


def steps(obstacles: BarrierBoxes, source, listeners, within=False) -> np.ndarray:
    """Largest change per octave from each place to the next [dB]."""
    levels = np.array([level(obstacles, source, place, within) for place in listeners])
    return np.abs(np.diff(levels, axis=0)).max(axis=0)


@pytest.mark.parametrize(("source", "distance"), [((-1.5, 0.5, 0), 2.5), ((-0.6, 2.0, 0), 1.0)])
def test_a_walk_past_a_doorway(source, distance):
    """Along a wall behind a door of 0.9 m, jambs and lintel 0.1 m thick, in steps of 5 cm."""
    t, half, top = 0.05, 0.45, 0.65
    wall = [([-t, -30, -30], [t, -half, 30]), ([-t, half, -30], [t, 30, 30]), ([-t, -half, top], [t, half, 30])]
    walk = [(distance, y, 0.1) for y in np.arange(-3, 3.01, 0.05)]
    assert np.all(steps(boxes(*wall), source, walk) < 1.5)


def test_obstacles_of_any_size():
    """A wardrobe takes much at high octaves and little at low ones; a table's leg takes hardly anything."""
    wardrobe = boxes(([-0.3, -0.5, -1.2], [0.3, 0.5, 0.6]))
    behind = level(wardrobe, (-1.5, 0.1, 0), (1.5, -0.2, 0.1), within=True)
    assert -2 < behind[0] < 0.1
    assert -25 < behind[6] < -12
    leg = boxes(([-0.03, -0.03, -0.8], [0.03, 0.03, -0.1]))
    assert np.all(abs(level(leg, (-1.5, 0, -0.5), (1, 0, -0.5), within=True)[:5]) < 1)
    walk = [(1.5, y, 0.1) for y in np.arange(-2, 2.01, 0.05)]
    assert np.all(steps(wardrobe, (-1.5, 0.1, 0), walk, within=True)[:3] < 1.5)


def test_boxes_that_meet_are_one():
    """A screen in two pieces, one upon the other, sounds as one; so does a turned one."""
    places = on_circle(60), on_circle(250, height=0.2)
    whole = level(screen(0.1), *places)
    pieces = boxes(([-0.05, -30, -30], [0.05, 0, 0.05]), ([-0.05, -30, 0.05], [0.05, 0, 30]))
    np.testing.assert_allclose(level(pieces, *places), whole, atol=0.2)
    turned = boxes(([-0.05, -30, -30], [0.05, 0, 30]), yaw=0.7)
    spin = np.array([[np.cos(0.7), np.sin(0.7), 0], [-np.sin(0.7), np.cos(0.7), 0], [0, 0, 1]])
    np.testing.assert_allclose(level(turned, *(p @ spin for p in places)), whole, atol=0.05)


@pytest.mark.parametrize("turn", [-20, -2, 2, 15, 45])
def test_walls_back_to_back_bend_sound_once(turn):
    """Two leaves of 1 cm, one behind the other, as one wall of 2 cm: their edges are no two obstacles."""
    places = on_circle(60), on_circle(240 + turn)
    leaves = boxes(([-0.01, -30, -30], [0, 0, 30]), ([0, -30, -30], [0.01, 0, 30]))
    np.testing.assert_allclose(level(leaves, *places), level(screen(0.02), *places), atol=1.0)
