"""Scenes carry their bank and backend through `vmap`: the bank is never copied."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms

from home_mjx.audio_jax import AudioConfig, Listener, SoundSource, impulse_response
from home_mjx.audio_jax.base.options import Traced
from home_mjx.audio_jax.propagation.surfaces import sound_materials
from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render import Camera, Lens, Scene, cast, make_scene, occluded, render
from home_mjx.raycast_render.backends.cpu import TARGET
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.types import SoundMaterials

E = 3
LEVEL = jnp.array([0.5**0.5, 0.5**0.5, 0, 0], jnp.float32)
CONFIG = AudioConfig(response_seconds=0.1, late=Traced(num_rays=4, num_bounces=2))


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox(furniture=[Furniture((1.0, 1.0), mass=5.0)]), two_rooms()])


def place(bank, house, backend=None):
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    return make_scene(bank, house, bank.physics.body_pos[house], bank.physics.body_quat[house], *nobody, backend)


def see(scene, eye):
    return render(scene, Camera(eye, LEVEL, jnp.float32(1.2)), Lens(4, 4), kinds=("rgb", "fine"), shader="lit")


def hear(scene, ears):
    source = SoundSource(jnp.array([-1.5, -1.0, 1.2]))
    return impulse_response(scene, source, Listener(ears, LEVEL), jax.random.key(0), CONFIG)


@pytest.fixture(scope="module")
def batch():
    return jnp.array([0, 1, 0]), jnp.array([[-1.0, -1, 1.5], [-2.0, 0, 1.5], [-0.5, -1, 1.2]])


# Two programs of sound round differently under some flags of XLA: those of these tests are among them.
@pytest.mark.parametrize(("sense", "rounding"), [(see, 0.0), pytest.param(hear, 1e-6, marks=pytest.mark.slow)])
def test_scenes_that_cross_the_border_of_vmap_give_what_scenes_inside_do(bank, batch, sense, rounding):
    houses, eyes = batch
    inside = jax.jit(jax.vmap(lambda house, eye: sense(place(bank, house), eye)))(houses, eyes)
    scenes = jax.jit(jax.vmap(lambda house: place(bank, house), out_axes=Scene.axes()))(houses)
    assert jax.tree.map(jnp.shape, scenes.bank) == jax.tree.map(jnp.shape, bank)
    assert scenes.house.shape == (E,)
    outside = jax.jit(jax.vmap(sense, in_axes=(Scene.axes(), 0)))(scenes, eyes)
    jax.tree.map(lambda x, y: np.testing.assert_allclose(x, y, 0, rounding * float(np.max(x))), inside, outside)


def shine(scene, factor):
    """Draw a scene that one factor makes brighter."""
    return scene.replace(appearance=AppearanceOverrides(seed=jnp.uint32(0), exposure=factor))


def muffle(scene, factor):
    """Give all materials of a scene one absorption and scattering."""
    field = jnp.full(sound_materials(scene).absorption.shape, factor)
    return scene.replace(sound_materials=SoundMaterials(absorption=field, scattering=field, transmission=0 * field))


def overridden(bank, override, sense):
    """Senses of scenes with an override each, built outside and inside of `vmap`."""
    eye, factors = jnp.array([-1.0, -1, 1.5]), jnp.array([0.2, 0.5, 0.9])
    build = jax.vmap(lambda factor: override(place(bank, jnp.int32(0)), factor), out_axes=Scene.axes())
    outside = jax.jit(jax.vmap(sense, in_axes=(Scene.axes(), None)))(jax.jit(build)(factors), eye)
    inside = jax.jit(jax.vmap(lambda factor: sense(override(place(bank, jnp.int32(0)), factor), eye)))(factors)
    return outside, inside


def test_appearance_that_crosses_the_border_of_vmap_reaches_its_environment(bank):
    draw = lambda scene, eye: render(scene, Camera(eye, LEVEL, jnp.float32(1.2)), Lens(4, 4), shader="fast")["rgb"]  # noqa: E731
    outside, inside = overridden(bank, shine, draw)
    means = [float(image.mean()) for image in np.asarray(outside)]
    assert means[0] < means[1] < means[2], means
    np.testing.assert_array_equal(outside, inside)


def test_sound_materials_that_cross_the_border_of_vmap_reach_their_environment(bank):
    outside, inside = overridden(bank, muffle, hear)
    energies = np.square(outside).sum(axis=tuple(range(1, outside.ndim)))
    assert energies[0] > energies[1] > energies[2]
    np.testing.assert_allclose(outside, inside, atol=1e-5 * float(np.abs(inside).max()))


def shapes_of(jaxpr):
    """Shapes of everything that a program computes, inner programs included."""
    for equation in jaxpr.eqns:
        yield from (v.aval.shape for v in equation.outvars)
        for leaf in jax.tree.leaves(list(equation.params.values())):
            inner = getattr(leaf, "jaxpr", leaf)
            if hasattr(inner, "eqns"):
                yield from shapes_of(inner)


def copies(function, bank, *args):
    """Large arrays of the bank that a program over E environments has E times."""
    found = set(shapes_of(jax.make_jaxpr(function)(bank, *args).jaxpr))
    large = [leaf.shape for leaf in jax.tree.leaves(bank) if leaf.size > 1000]
    assert len(large) > 10
    return [shape for shape in large if (E, *shape) in found]


@pytest.mark.parametrize("sense", [see, hear])
def test_no_program_copies_the_bank_for_each_environment(bank, batch, sense):
    def batched(bank, houses, eyes):
        return jax.vmap(lambda house, eye: sense(place(bank, house), eye))(houses, eyes)

    assert copies(batched, bank, *batch) == []
    assert copies(lambda bank, houses: jax.vmap(lambda h: place(bank, h))(houses), bank, batch[0]) != []


def test_every_ray_of_a_scene_is_cast_by_its_executor(bank):
    def lowered(sense, backend):
        eye = jnp.array([-1.0, -1, 1.5])
        return jax.jit(lambda bank: sense(place(bank, jnp.int32(0), backend), eye)).lower(bank).as_text()

    for sense in (see, hear, lambda s, eye: cast(s, eye, LEVEL[:3]), lambda s, eye: occluded(s, eye, LEVEL[:3])):
        assert TARGET not in lowered(sense, "xla")
        assert TARGET in lowered(sense, "cpu")
    assert TARGET not in lowered(lambda s, eye: cast(s, eye, LEVEL[:3], backend="xla"), "cpu")


def test_scenes_of_different_executors_are_different_trees(bank):
    """So that a compiled program of one is not taken for the other."""
    one, other = (place(bank, jnp.int32(0), name) for name in ("xla", "cpu"))
    assert jax.tree.structure(one) != jax.tree.structure(other)
    assert jax.tree.structure(one.replace(backend="cpu")) == jax.tree.structure(other)
