"""Textures of the second generator: enough, seamless in size, the same each time, of families that are known."""

from pathlib import Path

import numpy as np
import pytest

from home_mjx.core.progress import counts
from home_mjx.schema.categories import texture_family
from home_mjx.schema.material_kinds import TEXTURE_KINDS
from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.floor_plan.walls import RoomSurfaces
from home_procgen.meshes import build_room_meshes
from home_procgen.model_store import get_model
from home_procgen.presets import HOME_VARIANT
from home_procgen.primitives.palette import plain
from home_procgen.shipped import ShippedHomes
from home_procgen.textures import patterns
from home_procgen.textures.finishes import FINISHES
from home_procgen.textures.recipes import ALL_NAMES, RECIPES, canvas_of, texture, texture_names


def test_there_are_enough():
    pictures = [name for name in ALL_NAMES if name.startswith("picture_")]
    assert len(ALL_NAMES) - len(pictures) >= 150
    assert len(pictures) >= 40
    assert len(set(ALL_NAMES)) == len(ALL_NAMES)


def test_repeating_images_cover_two_metres_and_have_few_colours():
    """Some of every kind: at least 512 texels at 2 m a repeat, in a palette; pictures and rugs are shown once."""
    for name in (*ALL_NAMES[::17], "wood_1", "picture_1", "carpet_13", "front_1"):
        size = 256 if name.startswith("picture_") else 512
        assert texture(name).shape == (size, size, 3), name
        assert len(np.unique(texture(name).reshape(-1, 3), axis=0)) <= 256, name
    assert [canvas_of(name).metres for name in ("wood_1", "carpet_4", "carpet_13", "picture_2", "front_2")] == [
        2,
        2,
        1,
        1,
        1,
    ]


def test_images_do_not_repeat_within_their_two_metres():
    """Boards, tiles, stones and flowers are others in the second metre; regular weaves may repeat."""
    for name in ("wood_1", "prkt_1", "tile_6", "tile_11", "stone_5", "wallp_8", "wallp_13", "marble_1"):
        image = texture(name).astype(float)
        assert (
            abs(image[:, :256] - image[:, 256:]).mean() > 0.25 * abs(image[:, :256] - image[:, :256].mean()).mean()
        ), name


def test_images_are_seamless():
    """Across the edges, values differ no more than between lines inside."""
    for name in ("wood_7", "stone_1", "marble_2", "wallp_8", "wallp_13", "stone_3", "carpet_4", "textile_12"):
        image = texture(name).astype(float)
        inside = abs(np.diff(image, axis=0)).mean(axis=(1, 2)), abs(np.diff(image, axis=1)).mean(axis=(0, 2))
        edge = abs(image[0] - image[-1]).mean(), abs(image[:, 0] - image[:, -1]).mean()
        assert all(e < 2.5 * lines.max() for e, lines in zip(edge, inside, strict=True)), name


def test_joints_of_tiles_are_narrow():
    """At most 9 mm: two or three texels, not two of 8 mm."""
    row = texture("tile_1").astype(float).mean(axis=2)[10]
    joints = np.flatnonzero(np.diff(np.r_[0, row < 205, 0]))
    widths = np.diff(joints)[::2] * 2000 / 512
    assert len(widths) >= 7
    assert widths.max() < 9


def test_floors_and_things_show_two_metres_of_an_image():
    room = RoomPlan("Office", (Rect(0.0, 0.0, 6.0, 4.0),))
    floor = build_room_meshes(Path("fr_0rm_0"), room, 2.7, [], RoomSurfaces(*map(plain, ["#ffffff"] * 5)))[0]
    assert np.ptp(floor.uv.reshape(-1, 2), axis=0) == pytest.approx([3.0, 2.0])
    table = get_model("dining_table", 1)
    lengths = np.linalg.norm(np.diff(table.mesh.vertices[table.mesh.faces], axis=1), axis=-1)
    shown = np.linalg.norm(np.diff(table.mesh.uv, axis=1), axis=-1)
    assert (shown < lengths / 2 + 1e-4).all()
    rug = get_model("rug", 1)
    assert rug.mesh.uv.max() == 1.0


def test_images_differ_and_are_the_same_twice():
    names = list(RECIPES)[::5]
    images = {name: texture(name) for name in names}
    assert len({image.tobytes() for image in images.values()}) == len(images)
    assert min(image.std() for image in images.values()) > 1.0
    for name in names[::7]:
        np.testing.assert_array_equal(texture.__wrapped__(name), images[name])


def test_families_are_known():
    known = {*TEXTURE_KINDS, "picture"}
    assert {texture_family(name) for name in RECIPES} <= known


def test_finishes_name_textures_that_exist():
    used = {m.texture.stem for options in FINISHES.values() for m in options if m.texture is not None}
    assert used <= set(ALL_NAMES)
    assert set(texture_names("picture")) <= used


def test_tiles_have_grout_between_them():
    image = patterns.subway(np.random.default_rng(0), (0.2, 0.2, 0.2), (0.4, 0.4, 0.4), rows=4, columns=2)
    assert np.isclose(image.max(), 0.9)
    assert 0.02 < (image[..., 0] > 0.85).mean() < 0.2


def test_drawn_textures_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture):
    monkeypatch.setattr(counts, "DELAY", 0.0)
    monkeypatch.setattr(counts, "LINE_INTERVAL", 0.0)
    monkeypatch.setattr(counts, "LINE_SHARE", 0.0)
    names = [f"texture/{name}.png" for name in ALL_NAMES[:3]]
    for _ in range(2):  # the second time nothing is missing
        ShippedHomes(tmp_path / "homes", HOME_VARIANT).write_textures(names, progress=True)
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(" (once")[0] for line in lines] == ["home_mjx: drawing 3 textures"] * 3
    assert [line.split(" cached) ")[1][:3] for line in lines] == ["1/3", "2/3", "3/3"]
