"""A hole of a texture is a hole in every image of both shaders, in shadows and in lidars; panes by their opacity."""

from dataclasses import replace
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from PIL import Image

from home_mjx.datasets import RoomOutline, outline_house, write_house, write_library
from home_mjx.datasets.suncg.write.metadata import LibraryModel
from home_mjx.houses import load_bank
from home_mjx.raycast_render import Camera, Lens, make_scene, occluded, render
from home_mjx.schema.compiled import RayKind
from home_mjx.schema.house import Material, Mesh, ModelInfo, ObjectNode

QUAD = np.array([[-0.5, 0, 0], [0.5, 0, 0], [0.5, 1, 0], [-0.5, 1, 0]])  # [m]
CORNERS = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
GREEN, YELLOW = (30, 200, 40), (220, 210, 50)
HOLE, LEAF, WALL = (33, 33), (14, 14), (33, 1)  # pixels; the lower right quarter of each pane is cut out
PANE_DEPTH, WALL_DEPTH = 1.2, 3.2  # [m]
PLAIN = {"clear": 0.0, "glass": 0.3}  # panes without a texture, by `d`
SIZE = (12.0, 5.0)  # [m]
LEVEL = jnp.array([0.5**0.5, 0.5**0.5, 0.0, 0.0])  # looks along +y
KINDS = ("rgb", "albedo", "depth", "distance", "instance", "fine", "color", "material", "normal")


def textures():
    """Images with the lower right quarter cut out, by kind of file."""
    rgba = np.full((64, 64, 4), (*GREEN, 255), np.uint8)
    rgba[32:, 32:] = *YELLOW, 0
    hole = rgba[..., 3] == 0
    palette = Image.fromarray(hole.astype(np.uint8), "P")
    palette.putpalette([*GREEN, *YELLOW])
    grey = np.dstack([np.where(hole, 250, 90), rgba[..., 3]]).astype(np.uint8)
    return {
        "rgba": (Image.fromarray(rgba), {}),
        "entry": (palette, {"transparency": 1}),
        "entries": (palette, {"transparency": bytes([255, 0])}),
        "color": (Image.fromarray(rgba[..., :3]), {"transparency": YELLOW}),
        "grey": (Image.fromarray(grey, "LA"), {}),
    }


def pane(name, opacity):
    uv = QUAD[CORNERS][..., :2] + [0.5, 0]
    none = np.full(len(CORNERS), -1, np.int32)
    material = Material("m", (1.0, 1.0, 1.0), None, opacity)
    return Mesh(Path(f"object/{name}/{name}.obj"), QUAD, CORNERS, uv.astype(np.float32), none + 1, none, (material,))


@pytest.fixture(scope="module")
def panes(tmp_path_factory):
    """A bank of one house with a row of panes, and the x coordinate of each by name [m]."""
    root, images = tmp_path_factory.mktemp("panes"), textures()
    meshes = {name: pane(name, PLAIN.get(name, 1.0)) for name in (*images, *PLAIN)}
    infos = [ModelInfo(name, "picture_frame", "picture_frame", "otherprop") for name in meshes]
    models = [LibraryModel(info, mesh, ("n0", "x.n.01")) for info, mesh in zip(infos, meshes.values(), strict=True)]
    write_library(root, models, {})
    (root / "texture").mkdir(exist_ok=True)
    for name, (image, options) in images.items():
        image.save(root / "texture" / f"{name}.png", **options)
        mtl = root / "object" / name / f"{name}.mtl"
        mtl.write_text(f"{mtl.read_text()}\nmap_Kd ../../texture/{name}.png\n")
    objects, at = [], {}
    for i, name in enumerate(meshes):
        pose = np.eye(4)
        pose[:3, 3] = 1.8 + 1.4 * i, 0.8, 2.0
        at[name] = pose[0, 3] - SIZE[0] / 2
        objects.append(ObjectNode(f"0_{i + 1}", i + 1, "", None, name, name, pose))
    house = outline_house("h", [RoomOutline("Living_Room", [(0, 0), (SIZE[0], 0), SIZE, (0, SIZE[1])])])
    room = replace(house.levels[0].rooms[0], members=tuple(range(1, len(objects) + 1)))
    level = replace(house.levels[0], objects=tuple(objects), rooms=(room,))
    write_house(root, replace(house, levels=(level,), models=meshes))
    return load_bank(str(root)), at


def scene_of(bank):
    house, physics = jnp.int32(0), bank.physics
    return make_scene(
        bank, house, physics.body_pos[house], physics.body_quat[house], jnp.zeros((0, 3)), jnp.zeros((0, 4))
    )


@pytest.fixture(scope="module", params=["fast", "lit"])
def views(panes, request):
    """Images of each pane, seen from the front."""
    bank, at = panes

    def look(x):
        camera = Camera(jnp.stack([x, -0.7, 1.3]), LEVEL, jnp.deg2rad(60.0))
        return render(scene_of(bank), camera, Lens(48, 48), kinds=KINDS, shader=request.param)

    images = jax.device_get(jax.jit(jax.vmap(look))(jnp.array(list(at.values()), jnp.float32)))
    return {name: {kind: image[i] for kind, image in images.items()} for i, name in enumerate(at)}


@pytest.mark.parametrize("name", ["rgba", "entry", "entries", "color", "grey"])
def test_a_hole_is_a_hole_in_every_image(views, name):
    view = views[name]
    for kind in ("instance", "fine", "color", "material"):
        assert view[kind][HOLE] == view[kind][WALL] != view[kind][LEAF], kind
    assert view["depth"][HOLE][0] == pytest.approx(WALL_DEPTH, abs=0.05)
    assert view["depth"][LEAF][0] == pytest.approx(PANE_DEPTH, abs=0.02)
    assert view["distance"][HOLE][0] > WALL_DEPTH
    np.testing.assert_allclose(view["normal"][HOLE], view["normal"][WALL], atol=1e-5)
    np.testing.assert_allclose(view["albedo"][HOLE], view["albedo"][WALL], atol=1e-5)
    assert abs(view["rgb"][HOLE].astype(int) - view["rgb"][WALL]).max() < 40
    assert abs(view["rgb"][LEAF].astype(int) - view["rgb"][WALL]).max() > 40


@pytest.mark.parametrize("name", ["rgba", "entry", "entries", "color"])
def test_no_hole_darkens_its_edge(views, name):
    """Filters mix texels at the edge of a hole; its own colour, yellow or black, must not show."""
    view = views[name]
    shown = view["albedo"][view["instance"] == view["instance"][LEAF]]
    ratio = shown[:, 1] / shown.sum(axis=1)
    assert ratio.min() > 0.8
    color = view["rgb"][view["instance"] == view["instance"][LEAF]].astype(int)
    assert (color[:, 1] > 2 * color[:, 0]).all()


def test_panes_with_d_zero_are_nowhere(views):
    view = views["clear"]
    for kind in ("instance", "fine", "color", "material"):
        assert view[kind][LEAF] == view[kind][WALL], kind
    assert view["depth"][LEAF][0] == pytest.approx(WALL_DEPTH, abs=0.05)


def test_panes_with_d_between_are_surfaces_of_depth_and_ids(views):
    view = views["glass"]
    assert view["instance"][LEAF] not in (-1, view["instance"][WALL])
    assert view["depth"][LEAF][0] == pytest.approx(PANE_DEPTH, abs=0.02)


def test_light_passes_holes_and_sound_does_not(panes):
    """Rays through the hole and through the leaf of a pane; light passes panes with d < 1, too."""
    bank, at = panes
    hole, leaf, kinds = (0.25, -0.25), (-0.25, 0.25), (RayKind.CAMERA, RayKind.LIGHT, RayKind.SOUND)
    passed = {
        ("rgba", hole): (True, True, False),
        ("rgba", leaf): (False, False, False),
        ("clear", leaf): (True, True, False),
        ("glass", leaf): (False, True, False),
    }
    rays = [((at[name] + dx, -0.7, 1.3 + dz), int(kind)) for name, (dx, dz) in passed for kind in kinds]
    start, mask = (
        jnp.array(x, kind) for x, kind in zip(zip(*rays, strict=True), (jnp.float32, jnp.int32), strict=True)
    )
    ahead, reach = jnp.array([0.0, 1.0, 0.0]), PANE_DEPTH + 0.3
    hidden = jax.jit(lambda: occluded(scene_of(bank), start, ahead, t_max=reach, mask=mask))()
    assert dict(zip(passed, map(tuple, ~np.asarray(hidden).reshape(-1, 3)), strict=True)) == passed


def test_lidars_measure_what_is_behind_a_hole(panes):
    bank, at = panes
    camera = Camera(jnp.array([at["rgba"] + 0.25, -0.7, 1.05]), LEVEL, jnp.float32(0))
    lens = Lens(360, 1, "lidar", elevation=(0.0, 0.0))
    image = jax.jit(lambda: render(scene_of(bank), camera, lens, kinds=("depth", "instance"), depth_max=None))()
    depth, instance = np.asarray(image["depth"])[0, :, 0], np.asarray(image["instance"])[0]
    assert depth[[175, 180, 185]] == pytest.approx(WALL_DEPTH, abs=0.05)
    assert (instance[[175, 180, 185]] == -1).all()
    assert (abs(depth[[160, 200]] - PANE_DEPTH) < 0.1).any()
