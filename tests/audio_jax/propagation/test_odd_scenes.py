"""Sources and houses that no one should have: what is heard is defined, and never a number that is none."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from scenes import HEAD, scene_of

from home_mjx.audio_jax import AudioConfig, Listener, SoundSource, early_paths, impulse_response
from home_mjx.audio_jax.base.endpoints import is_indoors
from home_mjx.audio_jax.base.options import Omni, Traced

CONFIG = AudioConfig(receiver=Omni(), late=Traced(num_rays=16, num_bounces=6))
EARS = jnp.float32([1.4, 1.1, 1.6])
hear = jax.jit(impulse_response, static_argnums=4)


def heard(scene, source, ears=EARS) -> np.ndarray:
    return np.asarray(hear(scene, SoundSource(jnp.float32(source)), Listener(ears, HEAD), jax.random.key(0), CONFIG))


@pytest.mark.parametrize(("x", "indoors"), [(-1.0, True), (3.05, False), (9.0, False)])
def test_sources_in_walls_and_outside_are_told_and_finite(x, indoors):
    """In the room, in its wall of 0.1 m, and beyond it."""
    scene, place = scene_of(shoebox((6.0, 5.0, 3.0))), (x, 0.0, 1.0)
    assert bool(jax.jit(is_indoors)(scene, jnp.float32(place))) == indoors
    response = heard(scene, place)
    assert np.all(np.isfinite(response))
    assert (np.sum(response**2) > 1e-6) == indoors


def test_an_open_house_has_what_is_left():
    """Only the floor stands: the direct path, its reflection, and no late sound that has met two surfaces."""
    whole = shoebox((6.0, 5.0, 3.0), absorption=0.2, scattering=0.0)
    planes = replace(
        whole.planes,
        **{name: getattr(whole.planes, name)[4:5] for name in ("center", "normal", "axis_u", "axis_v", "material")},
    )
    model = whole.models[whole.instances.model[0]]
    floor = model.slot == 4  # of the six slabs
    assert floor.sum() == 12
    # Degenerate triangles are hit by no ray.
    bare = replace(model, triangle=np.where(floor[:, None, None], model.triangle, model.triangle[:, :1]))
    scene = scene_of(replace(whole, planes=planes, models={**whole.models, model.key: bare}))
    source = jnp.float32([-1.0, 0.0, 1.0])
    paths = jax.jit(early_paths, static_argnums=3)(scene, SoundSource(source), Listener(EARS, HEAD), CONFIG)
    loud = np.any(np.asarray(paths.gain) > 0, axis=1)
    image = np.array([-1.0, 0.0, -1.0])
    expected = [np.linalg.norm(x - np.asarray(EARS)) for x in (np.asarray(source), image)]
    np.testing.assert_allclose(np.sort(np.asarray(paths.distance)[loud]), expected, rtol=1e-5)
    response = heard(scene, source)
    assert np.all(np.isfinite(response))
    late = round((expected[1] / CONFIG.speed_of_sound + 0.05) * CONFIG.sample_rate)
    assert np.sum(response[:, late:] ** 2) < 1e-6 * np.sum(response**2)


def test_a_source_at_the_very_ears_is_loud_and_finite():
    scene = scene_of(shoebox((6.0, 5.0, 3.0)))
    response = heard(scene, EARS)
    assert np.all(np.isfinite(response))
    assert np.abs(response).max() > 1
