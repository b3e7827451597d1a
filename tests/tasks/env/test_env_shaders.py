"""Shaders per camera: a user's file registers one, cameras choose by name, and bakes follow from it."""

import dataclasses
import importlib.util
import sys
from pathlib import Path
from typing import ClassVar

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from lit_scenes import table

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.houses import add_bakes, bakes, register_bake
from home_mjx.raycast_render import Lens, LitShader, Shader, Vec, register_shader
from home_mjx.raycast_render.shaders import base
from home_mjx.registry import EnvSpec
from home_mjx.tasks import AgentCamera, EnvConfig, HouseholdEnv
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.status import Status
from home_mjx.tasks.env.checks import check_variation
from home_mjx.tasks.variation.ranges import Variation

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "own_shader.py"
FEW = {"width": 8, "height": 6, "impl": "kinematic"}


@dataclasses.dataclass(frozen=True)
class Area:
    """Record of the bake: the floor area of a house [m^2]."""

    value: np.ndarray


class FloorArea:
    """A bake of one number per house."""

    name, version, options, record, unused = "floor_area", 1, None, Area, frozenset()

    def bake_house(self, bank, index, house):
        return Area(np.full((), 30.0, np.float32))

    def stack(self, records, houses, bank):
        return jnp.stack([jnp.asarray(record.value) for record in records])


@dataclasses.dataclass(frozen=True)
class AreaShader(Shader):
    """Colour by the floor area of the house."""

    name: ClassVar[str] = "area"
    needs: ClassVar[tuple[str, ...]] = ("floor_area",)

    def radiance(self, scene, rays):
        level = scene.bank.bakes["floor_area"][scene.house] / 30
        return Vec(*[jnp.broadcast_to(level, rays.hit.t.shape)] * 3)


@pytest.fixture(autouse=True)
def registries(monkeypatch):
    """What a test registers is gone after it."""
    monkeypatch.setattr(base, "_REGISTRY", dict(base._REGISTRY))
    monkeypatch.setattr(bakes, "_REGISTRY", dict(bakes._REGISTRY))


@pytest.fixture(scope="module")
def house():
    return shoebox()


@pytest.fixture(scope="module")
def bank(house):
    return HouseBank.from_compiled([house])


def run_user_file(name):
    """Import the example as a user's module."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def first_images(bank, **options):
    env = home_mjx.make("PointNav-v0", bank, **FEW, **options)
    state = jax.jit(env.reset)(jax.random.key(0))
    return {name: np.asarray(image) for name, image in state.obs.items() if name.startswith("pixels/")}


def test_cameras_choose_a_shader_of_a_users_file_by_name(bank, monkeypatch):
    monkeypatch.setitem(sys.modules, "shader_of_a_user", None)
    user = run_user_file("shader_of_a_user")
    lens, kinds = Lens(8, 6), ("rgb", "depth", "normal")
    cameras = (
        AgentCamera("named", kinds, lens, shader="depth_normals"),
        AgentCamera("near", kinds, lens, shader=user.DepthNormals(half_distance=1.0)),
        AgentCamera("plain", kinds, lens),
    )
    images = first_images(bank, sensors=("rgb",), shader="depth_normals", cameras=cameras)
    np.testing.assert_array_equal(images["pixels/head_rgb"], images["pixels/named_rgb"])
    # Depth is along the optical axis; the distance is along the ray.
    slope = np.tan(np.pi / 4) / 3
    x, y = np.meshgrid((np.arange(8) - 3.5) * slope, (np.arange(6) - 2.5) * slope)
    distance = images["pixels/named_depth"] * np.sqrt(1 + x**2 + y**2)[..., None]
    for name, half in (("named", 3.0), ("near", 1.0)):
        light = (images["pixels/named_normal"] + 1) / 2 * 2 ** (-distance / half)
        curve = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light.clip(1e-9) ** (1 / 2.4) - 0.055)
        np.testing.assert_allclose(images[f"pixels/{name}_rgb"], 255 * curve, atol=0.51)
    assert (images["pixels/plain_rgb"] != images["pixels/named_rgb"]).any()


def test_the_option_is_the_head_cameras_alone():
    config = EnvConfig(sensors=("rgb",), shader="lit", cameras=(AgentCamera("other"),))
    assert [camera.shader for camera in config.all_cameras] == ["lit", "fast"]
    assert [shader.name for shader in config.shaders] == ["lit", "fast"]
    assert EnvConfig(sensors=("depth",), shader="lit").shaders == ()


def test_specs_keep_the_shader():
    lit = LitShader(num_lights=1)
    cameras = (AgentCamera("other", shader=lit),)
    spec = EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav", {"shader": "lit", "cameras": cameras})
    assert EnvSpec.from_json(spec.to_json()) == spec


def test_a_bake_that_a_shader_needs_is_required(bank, house):
    register_shader(AreaShader)
    register_bake("floor_area", FloorArea)
    core = HouseholdEnv(make_config(sensors=("rgb",), cameras=(AgentCamera("area", shader="area"),), **FEW))
    assert [bake.name for bake in core.bakes] == ["floor_area"]
    with pytest.raises(ConfigError, match=r"needs the bake `floor_area`, which the bank does not have.*add_bakes"):
        core.bind(bank)
    env = core.bind(add_bakes(bank, [house], core.bakes))
    assert (jax.jit(env.reset)(jax.random.key(0)).obs["pixels/area_rgb"] == 255).all()


def test_a_bake_that_a_shader_only_uses_is_read_where_the_bank_has_it(house):
    """`lit` draws with light probes after `add_bakes`, and without them before; the environment asks for no bake."""
    lamp = dataclasses.replace(house, lights=table({"pos": (1.0, 0.0, 2.0)}, rooms=len(house.rooms.type)))
    bank, images = HouseBank.from_compiled([lamp]), []
    for drawn in (bank, add_bakes(bank, [lamp], "light_probes")):
        env = home_mjx.make("PointNav-v0", drawn, sensors=("rgb",), shader="lit", **FEW)
        assert "light_probes" not in [bake.name for bake in env.core.bakes]
        state = jax.jit(env.reset)(jax.random.key(0))
        assert Status(int(state.status)) == Status(0)
        images.append(np.asarray(state.obs["pixels/head_rgb"], int))
    assert np.abs(images[0] - images[1]).mean() > 1


def test_cameras_without_colours_need_no_bake(bank):
    register_shader(AreaShader)
    config = make_config(sensors=("depth",), shader="area", cameras=(AgentCamera("a", ("depth",), shader="area"),))
    core = HouseholdEnv(config)
    assert core.bakes == ()
    core.bind(bank)


def test_a_bake_that_does_not_exist_is_refused(bank):
    register_shader(AreaShader)
    with pytest.raises(UnknownNameError, match="unknown bake `floor_area`"):
        HouseholdEnv(make_config(sensors=("rgb",), shader="area")).bind(bank)


def test_lights_vary_if_a_camera_shows_them():
    lamps = Variation.of(lamps=0.5)
    check_variation(EnvConfig(sensors=("rgb",), cameras=(AgentCamera("other", shader="lit"),)), lamps)
    for options, words in (
        ({"sensors": ("rgb",)}, "shader `fast` does not use it"),
        ({"sensors": ("depth",), "shader": "lit"}, "No camera has the kind `rgb`"),
    ):
        with pytest.raises(ConfigError, match=f'`lamps` cannot vary here.*{words}.*shader="lit"'):
            check_variation(EnvConfig(**options), lamps)


@pytest.mark.parametrize("make", [lambda name: AgentCamera("a", shader=name), lambda name: EnvConfig(shader=name)])
def test_unknown_shaders_are_refused(make):
    with pytest.raises(UnknownNameError, match=r"unknown shader `list`.*Did you mean `lit`"):
        make("list")
