"""The registry of shaders: what it takes, finds and refuses, and what a shader must return."""

import dataclasses
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from lit_scenes import scene_of

from home_mjx.bank.bank import HouseBank
from home_mjx.core.jsonable import from_json, to_json
from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.raycast_render import Camera, FastShader, Lens, LitShader, Shader, Vec, render
from home_mjx.raycast_render.shaders import base
from home_mjx.raycast_render.shaders.base import register_shader, resolve_shader, shader_names

CAMERA = Camera(jnp.array([0.0, 0.0, 1.5]), jnp.array([0.5**0.5, 0.5**0.5, 0, 0]), jnp.float32(1.2))


@pytest.fixture(autouse=True)
def registry(monkeypatch):
    """What a test registers is gone after it."""
    monkeypatch.setattr(base, "_REGISTRY", dict(base._REGISTRY))


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox()])


@dataclasses.dataclass(frozen=True)
class Flat(Shader):
    """One colour everywhere."""

    name: ClassVar[str] = "flat"
    level: float = 0.5

    def radiance(self, scene, rays):
        return Vec(*[jnp.full_like(rays.hit.t, self.level)] * 3)


@dataclasses.dataclass(frozen=True)
class BakedLevel(Flat):
    """A colour that a bake holds, by house."""

    name: ClassVar[str] = "baked_level"
    needs: ClassVar[tuple[str, ...]] = ("level",)

    def radiance(self, scene, rays):
        return Vec(*[jnp.broadcast_to(scene.bank.bakes["level"][scene.house], rays.hit.t.shape)] * 3)


def look(bank, shader, samples=1):
    return np.asarray(render(scene_of(bank), CAMERA, Lens(4, 3, samples=samples), kinds=("rgb",), shader=shader)["rgb"])


def test_names_and_instances_resolve():
    assert resolve_shader("fast") == FastShader()
    assert resolve_shader("lit") == LitShader()
    assert resolve_shader(LitShader(num_lights=1)).num_lights == 1
    assert shader_names() == ("baked", "fast", "lit", "night")
    assert register_shader(Flat) is Flat
    assert resolve_shader("flat") == Flat()
    assert shader_names() == ("baked", "fast", "flat", "lit", "night")


@pytest.mark.parametrize("samples", [1, 3])
def test_a_registered_shader_draws_by_name_and_with_options(bank, samples):
    register_shader(Flat)
    level = 255 * (1.055 * np.array([0.5, 0.2]) ** (1 / 2.4) - 0.055)
    assert (look(bank, "flat", samples) == round(level[0])).all()
    assert (look(bank, Flat(0.2), samples) == round(level[1])).all()
    assert (look(bank, Flat(7.0), samples) == 255).all(), "display light is clipped"


def test_registering_a_name_again_replaces_it(bank):
    register_shader(Flat)
    register_shader(dataclasses.make_dataclass("Flat", [("level", float, 0.0)], bases=(Flat,), frozen=True))
    assert (look(bank, "flat") == 0).all()


def test_a_shader_reads_its_bake_and_is_refused_without(bank):
    assert (look(bank.replace(bakes={"level": jnp.ones(1)}), BakedLevel()) == 255).all()
    with pytest.raises(ConfigError, match="`baked_level` needs the bake `level`, which the bank does not have"):
        look(bank, BakedLevel())
    render(scene_of(bank), CAMERA, Lens(4, 3), kinds=("depth",), shader=BakedLevel())  # no colours, no bake


def test_a_shader_of_a_distribution_is_found_by_its_entry_point(monkeypatch):
    class Point:
        def load(self):
            return Flat

    monkeypatch.setattr(base, "installed", lambda group: {"flat": Point()})
    assert shader_names() == ("baked", "fast", "flat", "lit", "night")
    assert resolve_shader("flat") == Flat()


def test_options_survive_json():
    for shader in (FastShader(), LitShader.from_hour(8), Flat(0.25)):
        assert from_json(to_json({"shader": shader})) == {"shader": shader}


class Thawed(Shader):
    name = "thawed"

    def radiance(self, scene, rays):
        return Vec(0.0, 0.0, 0.0)


@dataclasses.dataclass(frozen=True)
class Nameless(Thawed):
    name = ""


@dataclasses.dataclass(frozen=True)
class Demanding(Thawed):
    level: float


@dataclasses.dataclass(frozen=True)
class Spelled(Thawed):
    needs = "light"


@dataclasses.dataclass(frozen=True)
class Blind:
    name: ClassVar[str] = "blind"


@pytest.mark.parametrize(
    ("shader", "words"),
    [
        (Thawed, "shader Thawed is not a frozen dataclass.*frozen=True"),
        (Nameless, "Nameless has no name"),
        (Demanding, "cannot be made without options.*default"),
        (Spelled, "`needs` of the shader Spelled must be a tuple of names, got 'light'"),
        (Blind, "Blind does not have the method `radiance`"),
        (Flat(), "expected a class of shaders"),
    ],
)
def test_classes_that_are_not_shaders_are_refused(shader, words):
    with pytest.raises(ConfigError, match=words):
        register_shader(shader)
    assert shader_names() == ("baked", "fast", "lit", "night")


@pytest.mark.parametrize(
    ("spec", "words"),
    [(Thawed(), "Thawed is not a frozen dataclass"), (Flat([1.0]), "options of the shader `flat` must be numbers")],
)
def test_instances_that_cannot_be_options_are_refused(spec, words):
    with pytest.raises(ConfigError, match=words):
        resolve_shader(spec)


def test_unknown_names_are_refused_with_the_closest():
    register_shader(Flat)
    with pytest.raises(UnknownNameError, match=r"unknown shader `flad`.*Did you mean `flat`"):
        resolve_shader("flad")


@pytest.mark.parametrize("light", [jnp.zeros((3, 4, 3)), Vec(0.0, 0.0, 0.0), Vec(*[jnp.zeros((4, 3))] * 3)])
def test_light_of_another_shape_is_refused(bank, light, monkeypatch):
    monkeypatch.setattr(Flat, "radiance", lambda *_: light)
    with pytest.raises(ConfigError, match=r"`flat` must return a Vec with components of shape \(3, 4\)"):
        look(bank, Flat())
