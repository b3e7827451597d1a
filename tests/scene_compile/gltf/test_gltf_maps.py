"""Emission and maps of physically based materials: from a GLB through the cache to pixels, GLB and MJCF."""

import xml.etree.ElementTree as ET

import jax.numpy as jnp
import numpy as np
import pytest
from gltf_files import CUBE, two_rooms
from gltf_rules import find_faults, split
from PIL import Image

from home_mjx.bank.bank import HouseBank
from home_mjx.core.color import decode_srgb
from home_mjx.datasets import open_dataset
from home_mjx.houses.house_cache import load_compiled
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.shaders.lit import GLOW_RADIANCE, LitShader
from home_mjx.scene_compile.gltf.export import export_gltf
from home_mjx.scene_compile.mjcf.export import export_mjcf

COLORS = {"emission": (0, 188, 0), "normal": (128, 128, 255), "roughness": (0, 200, 50), "occlusion": (90, 90, 90)}


@pytest.fixture
def flat(tmp_path, monkeypatch):
    """Two rooms with a television that glows: emission 2, 4, 0 times the green of an image, and all other maps."""
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    file = two_rooms()
    for name, color in COLORS.items():
        Image.new("RGB", (2, 2), color).save(tmp_path / f"{name}.png")
        view = file.view((tmp_path / f"{name}.png").read_bytes())
        file.add("textures", source=file.add("images", bufferView=view, mimeType="image/png", name=name))
    shade = {"metallicFactor": 0.75, "roughnessFactor": 0.5, "metallicRoughnessTexture": {"index": 2}}
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}}
    material = file.add(
        "materials",
        name="screen",
        pbrMetallicRoughness=shade,
        emissiveFactor=[0.5, 1.0, 0.0],
        emissiveTexture={"index": 0},
        normalTexture={"index": 1, "scale": 0.3},
        occlusionTexture={"index": 3},
        extensions=strength,
    )
    uv = file.accessor(np.tile([[0, 0], [1, 0], [0, 1]], (12, 1)))
    mesh = file.mesh(CUBE, material=material, attributes={"TEXCOORD_0": uv})
    file.node(name="television", mesh=mesh, translation=[6, 0.75, 3.4], scale=[1, 0.6, 0.1])
    return open_dataset(file.write(tmp_path / "flat.glb"))


def images(maps) -> list[tuple[int, int, int]]:
    return [Image.open(path).convert("RGB").getpixel((0, 0)) for path in maps.images]


def test_maps_pass_the_cache_and_a_glb(flat, tmp_path):
    house = load_compiled(flat, "flat")
    again = load_compiled(open_dataset(flat.name), "flat")  # from the cache
    written = export_gltf(house, tmp_path / "out.glb")
    assert find_faults(*split(written.read_bytes())) == []
    back = load_compiled(open_dataset(f"gltf:{written}"), "out")
    for one in (house, again, back):
        maps = one.materials.maps
        assert len(maps.row) == 1
        np.testing.assert_allclose(maps.emission, [[2, 4, 0]], atol=1e-6)
        np.testing.assert_allclose(maps.glow, [[0, 4 * decode_srgb(np.array(188 / 255)), 0]], atol=1e-6)
        np.testing.assert_allclose(maps.factors, [[0.75, 0.5, 0.3, -1]], atol=1e-6)
        assert images(maps) == list(COLORS.values())


def test_emission_is_added_to_the_light_of_its_pixels_alone(flat):
    house = load_compiled(flat, "flat")
    bank = HouseBank.from_compiled([house])
    dark = bank.replace(lights=bank.lights.replace(glow=jnp.zeros_like(bank.lights.glow)))
    nothing = jnp.zeros((0, 3)), jnp.zeros((0, 4))
    along_minus_y = jnp.array([0.0, 0.0, 0.5**0.5, 0.5**0.5])
    camera = Camera(jnp.array([6.5, -2.2, 1.0]) + house.offset, along_minus_y, jnp.float32(1.2))
    for shader, unit in (("fast", None), (LitShader(), GLOW_RADIANCE)):
        kind = "rgb" if unit is None else "radiance"
        found = []
        for one in (bank, dark):
            body = one.physics.body_pos[0], one.physics.body_quat[0]
            scene = make_scene(one, jnp.int32(0), *body, *nothing)
            found.append(render(scene, camera, Lens(32, 24), kinds=(kind, "instance"), shader=shader))
        screen = np.asarray(found[0]["instance"]) == television(house)
        assert 0.02 < screen.mean() < 0.9
        more = np.asarray(found[0][kind], float) - np.asarray(found[1][kind], float)
        assert (more[~screen] == 0).all()
        assert (more[screen][:, 1] >= 0).all()  # a white surface near the camera is as bright as a pixel can be
        assert (more[screen][:, 1] > 0).mean() > 0.5
        if unit is not None:
            np.testing.assert_allclose(
                more[screen], np.tile(house.materials.maps.glow * unit, (screen.sum(), 1)), atol=1e-5
            )


def television(house) -> int:
    row = next(i for i, key in enumerate(house.instances.model) if key.startswith("television"))
    return int(house.instances.object_id[row])


def test_emission_passes_mjcf(flat, tmp_path):
    house = load_compiled(flat, "flat")
    path = export_mjcf(house, tmp_path / "mjcf")
    emission = [float(m.get("emission", 0)) for m in ET.parse(path).iter("material")]
    assert sorted(emission)[-2:] == pytest.approx([0, 1])
    back = load_compiled(
        open_dataset(f"mjcf:{tmp_path / 'mjcf'}"), open_dataset(f"mjcf:{tmp_path / 'mjcf'}").house_ids[0]
    )
    assert back.materials.maps.glow.max() == pytest.approx(1.0, abs=1e-3)
