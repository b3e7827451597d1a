"""Colours, materials and sizes by HoME's rules, of surfaces and models whose answer is known."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from benchmarks.home2017.__main__ import main
from benchmarks.home2017.semantics import (
    HOME2017,
    front_volumes,
    home2017_appearance,
    home2017_semantics,
    home2017_size,
)
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.read.metadata import read_metadata
from home_mjx.scene_compile.materials.surface import SurfaceMaterial
from home_mjx.scene_compile.semantics.appearance import TexturedTriangles
from home_mjx.scene_compile.semantics.engine import house_semantics
from home_mjx.schema.house import Metadata, ModelInfo

QUAD = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)  # texture coordinates of a whole image
RED, BLUE = (255, 0, 0), (0, 0, 255)


def skin(areas: list[float], surfaces: list[SurfaceMaterial], uv: np.ndarray = QUAD) -> TexturedTriangles:
    """Two triangles per surface, of the given areas together."""
    half = np.repeat(np.array(areas) / 2, 2)
    return TexturedTriangles(
        half, np.tile(uv, (len(areas), 1, 1)), np.repeat(np.arange(len(areas)), 2), tuple(surfaces)
    )


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from generated import generate_flats

    folder = tmp_path_factory.mktemp("houses")
    generate_flats(folder, range(1))
    return folder


def test_home_takes_the_mean_of_the_whole_image_and_no_diffuse_colour(tmp_path):
    halves = tmp_path / "wood_1.png"
    Image.fromarray(np.array([[RED] * 4] * 2 + [[BLUE] * 4] * 2, np.uint8)).save(halves)
    upper = QUAD * [1, 0.5] + [0, 0.5]
    look = home2017_appearance(skin([1.0], [SurfaceMaterial((0, 1, 0), texture=str(halves))], upper), HOME2017)
    assert look.colors["basic"] == ("purple",)
    assert look.materials == ("wood",)


def test_home_adds_up_slots_of_one_colour_and_drops_small_ones():
    reds = [SurfaceMaterial((1, 0, 0))] * 2
    look = home2017_appearance(skin([0.15, 0.15, 0.7], [*reds, SurfaceMaterial((0, 0, 1))]), HOME2017)
    assert look.colors["css"] == ("blue", "red")
    assert (
        home2017_appearance(
            skin([0.1] * 10, [SurfaceMaterial((x, 0, 0)) for x in np.linspace(0, 1, 10)]), HOME2017
        ).colors["basic"]
        == ()
    )


def test_sizes_compare_volumes_of_models_that_face_one_way():
    sized = [
        ModelInfo(str(i), "a", "chair", dims=(e, 1.0, 1.0), front=(0.0, 0.0, 1.0)) for i, e in enumerate([1, 2, 3])
    ]
    turned = ModelInfo("turned", "a", "chair", dims=(2.0, 1.0, 1.0), front=(1.0, 0.0, 0.0))
    volumes = front_volumes(Metadata({info.model_id: info for info in [*sized, turned]}))
    assert [home2017_size(volumes, info) for info in [*sized, turned]] == ["small", "normal", "large", ""]
    assert home2017_size(volumes, ModelInfo("x", dims=None)) == ""


def test_only_objects_are_described_by_homes_rules(root):
    dataset = open_dataset(root)
    house = dataset.load_house(dataset.house_ids[0])
    ours, home = (find(house, dataset.metadata) for find in (house_semantics, home2017_semantics))
    assert [item.description for item in home.objects] != [item.description for item in ours.objects]
    assert {item.size for item in home.objects} <= {"small", "normal", "large", "huge", ""}
    assert [item.support for item in home.objects] == [item.support for item in ours.objects]
    assert [part.appearance.colors for part in home.parts] == [part.appearance.colors for part in ours.parts]


def test_the_command_prints_a_line_per_object(root, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["home2017", "--dataset", str(root), "--json"])
    main()
    record = json.loads(capsys.readouterr().out)
    monkeypatch.setattr(sys, "argv", ["home2017", "--dataset", str(root)])
    main()
    lines = capsys.readouterr().out.splitlines()
    assert [line.endswith(item["description"]) for line, item in zip(lines, record["objects"], strict=True)]


@pytest.mark.real
def test_no_model_of_the_full_tables_is_tiny(suncg_root):
    folder = suncg_root.parent / "suncg_metadata_v1"
    if not folder.is_dir():
        pytest.skip("the full SUNCG v1 metadata is not beside the sample")
    full = read_metadata(folder)
    volumes = front_volumes(full)
    sizes = {home2017_size(volumes, info) for info in full.models.values() if info.dims is not None}
    assert sizes == {"small", "normal", "large", "huge", ""}
