"""Colour names against what the ray caster draws: texture coordinates, diffuse colours and areas in one go."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.core.color import ciede2000, linear_to_lab
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.schema.color_names import palettes
from home_mjx.schema.semantic import Semantic

# [m]; from one height alone, worktops of 17 % of a cabinet's area cover 29 % of its pixels.
EYE_HEIGHTS = (0.7, 1.4)
ENOUGH, SAMPLE = 150, 100  # pixels


@jax.jit
def look(bank, eye, quat):
    nobody = jnp.array([[0.0, 0.0, -50.0]]), jnp.array([[1.0, 0, 0, 0]])
    scene = make_scene(bank, jnp.int32(0), bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody)
    camera = Camera(eye, quat, jnp.float32(1.5))
    return render(scene, camera, Lens(64, 48), kinds=("albedo", "instance"))


def level_camera(yaw: float) -> np.ndarray:
    """Orientation of a level camera that looks along `yaw`: a turn about +z of one that looks along +x."""
    cos, sin = np.cos(yaw / 2), np.sin(yaw / 2)
    return np.array([cos + sin, cos + sin, sin - cos, sin - cos], np.float32) / 2


def pixels_by_object(bank) -> dict[int, np.ndarray]:
    """Albedo of all pixels in which an object is seen from some starts at two heights in four directions.

    Panes are left out: names count them by their opacity, but images show their own albedo in all of their pixels.
    """
    seen: dict[int, list] = {}
    panes = np.asarray(bank.materials.albedo)
    panes = panes[(panes[:, 3] < 1) & (panes[:, 3] > 0), :3]
    starts = np.asarray(bank.navigation.start[0])[::30]
    for start, height in itertools.product(starts, EYE_HEIGHTS):
        for yaw in np.arange(4) * np.pi / 2:
            image = look(bank, jnp.asarray(start + np.array([0, 0, height]), jnp.float32), level_camera(yaw))
            albedo, ids = np.asarray(image["albedo"], float), np.asarray(image["instance"])
            is_pane = (np.abs(albedo[..., None, :] - panes) < 1e-3).all(axis=-1).any(axis=-1)
            ids = np.where(is_pane, -1, ids)
            for i in np.unique(ids[ids >= 0]).tolist():
                seen.setdefault(i, []).append(albedo[ids == i])
    return {i: np.concatenate(found) for i, found in seen.items()}


def test_objects_have_the_colours_that_are_seen(generated_bank):
    seen = {i: pixels for i, pixels in pixels_by_object(generated_bank).items() if len(pixels) >= ENOUGH}
    ids, palette = jnp.asarray(sorted(seen)), palettes()["css"].lab
    columns = (Semantic.CSS, Semantic.CSS_2, Semantic.CSS_3)
    rows = np.stack([np.asarray(generated_bank.semantics_of(0, ids, c)) for c in columns], axis=1)
    right = []
    for i, colors in zip(ids.tolist(), rows.tolist(), strict=True):
        lab = linear_to_lab(seen[i].astype(float))
        named = [color for color in colors if color >= 0]
        # Most pixels, not their median: that of a picture may be a colour which is nowhere in it.
        gaps = [ciede2000(pixel[None], palette[named]).min() for pixel in lab[:: len(lab) // SAMPLE]]
        assert np.mean(np.array(gaps) < 16) > 0.65
        difference = ciede2000(np.median(lab, axis=0)[None], palette)
        right.append(int(difference.argmin()) in named)
    assert len(right) >= 10
    assert np.mean(right) > 0.8
