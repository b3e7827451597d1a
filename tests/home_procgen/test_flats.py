"""Flats: homes of one storey that cost little, and low detail of the same models."""

from dataclasses import replace

import numpy as np
import pytest

from home_mjx.datasets import open_dataset, validate_house
from home_mjx.errors import ConfigError, DatasetError, UnknownIdError
from home_mjx.scene_compile import compile_house
from home_procgen import build_home, generate_dataset
from home_procgen.design import draw_design
from home_procgen.model_store import library
from home_procgen.presets import PRESETS, Variant
from home_procgen.primitives.detail import build_coarsely, limit_sides, simplify_line, simplify_outline
from home_procgen.shapes.rounded import rounded_box

FLAT = Variant("flat")
SEEDS = range(6)


def test_flats_have_one_storey_of_three_to_six_rooms_and_no_surroundings():
    for seed in SEEDS:
        (level,) = build_home(seed, FLAT).levels
        assert 3 <= len(level.rooms) <= 6
        assert (len(level.boxes), len(level.grounds)) == (0, 0)
        assert {item.model_id.split("_")[0] for item in level.objects} <= {"home", "gen"}
        assert 8 * len(level.rooms) <= len(level.objects) <= 22 * len(level.rooms)


def test_low_detail_changes_meshes_and_no_places():
    low, full = (build_home(1, replace(FLAT, detail=detail)) for detail in ("low", "full"))
    places = [[(o.model_key, o.transform.tolist()) for o in house.levels[0].objects] for house in (low, full)]
    assert places[0] == places[1]
    triangles = [sum(len(h.models[o.model_key].faces) for o in h.levels[0].objects) for h in (low, full)]
    assert 3 * triangles[0] < triangles[1]
    assert triangles[0] < 25_000
    assert low.id != full.id


def test_written_flats_are_valid_and_compile_to_few_arrays(tmp_path):
    (name,) = generate_dataset(tmp_path, [2], preset="flat")
    dataset = open_dataset(tmp_path)
    assert validate_house(dataset, name) == ()
    house = compile_house(dataset.load_house(name), dataset.metadata)
    assert len(house.colliders.pos) < 256
    assert house.report["triangles"] < 30_000
    with pytest.raises(DatasetError, match="other houses than those of `preset=flat&detail=full`") as caught:
        generate_dataset(tmp_path, [2], preset="flat", detail="full")
    assert "`--preset flat --detail low`" in caught.value.hint


def test_low_models_have_the_box_slots_joints_and_lights_of_full_ones():
    for model, low in zip(library().values(), library("low").values(), strict=True):
        assert (low.id, low.slots, low.lights) == (model.id, model.slots, model.lights)
        assert set(np.unique(low.mesh.slot)) == set(range(len(low.slots))), model.id
        motions = [[replace(joint, face_ranges=()) for joint in one.joints] for one in (model, low)]
        assert motions[0] == motions[1], model.id
        for mesh, coarse in zip(model.meshes, low.meshes, strict=True):
            if mesh is not None and coarse is not None:
                bounds = [np.stack([m.vertices.min(axis=0), m.vertices.max(axis=0)]) for m in (mesh, coarse)]
                np.testing.assert_allclose(*bounds, atol=2e-5, err_msg=model.id)


def test_low_models_have_few_triangles_and_are_closed():
    counts = []
    for model in library("low").values():
        for mesh in filter(None, model.meshes):
            edges = mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
            code, back = (edges @ [len(mesh.vertices), 1], edges[:, ::-1] @ [len(mesh.vertices), 1])
            assert len(np.unique(code)) == len(code), model.id
            np.testing.assert_array_equal(np.sort(code), np.sort(back), err_msg=model.id)
        counts.append(len(model.mesh.faces))
    full = [len(model.mesh.faces) for model in library().values()]
    assert np.median(counts) < 220
    assert max(counts) < 1200
    assert sum(counts) < 0.25 * sum(full)


def test_shapes_are_coarse_only_within_the_context():
    line = np.stack([np.linspace(0, 1, 9), 0.01 * np.sin(np.linspace(0, 9, 9))], -1)
    ring = np.stack([np.cos(np.arange(24) * np.pi / 12), np.sin(np.arange(24) * np.pi / 12)], -1)
    with build_coarsely(1.0):
        assert (limit_sides(24, 0.2), len(simplify_line(line, 0.1))) == (8, 2)
        assert len(rounded_box("x", (1, 1, 1)).faces) == 12
        assert 3 <= len(simplify_outline(ring, 0.2)) < 24
    assert (limit_sides(24, 0.2), len(simplify_line(line, 0.1)), len(simplify_outline(ring, 0.2))) == (24, 9, 24)


def test_the_variant_of_a_seed_has_an_id_and_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    options = ("", "?detail=low", "?preset=flat", "?preset=flat&detail=full")
    opened = [open_dataset(f"procedural:3{text}") for text in options]
    assert (
        len({dataset.house_ids[0] for dataset in opened}) == len({dataset.root for dataset in opened}) == len(options)
    )
    assert opened[2].root == tmp_path / "generated-v5-flat-low"
    assert open_dataset("procedural:3?preset=flat&detail=low").house_ids[1] == opened[2].house_ids[1]
    opened[2].check_known(opened[2].house_ids[2])
    for other in (opened[3].house_ids[0], Variant("flat").house_id(3), "0" * 32):
        with pytest.raises(UnknownIdError):
            opened[2].check_known(other)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"preset": "flats"}, "unknown preset of generated houses `flats`"),
        ({"detail": "lo"}, "unknown detail of generated houses `lo`"),
    ],
)
def test_unknown_presets_and_details_are_refused(tmp_path, options, words):
    with pytest.raises(ConfigError, match=words):
        generate_dataset(tmp_path / "x", [0], **options)
    assert not (tmp_path / "x").exists()


def test_the_same_seed_draws_the_same_flat():
    one, again = (draw_design(3, preset=PRESETS["flat"]) for _ in range(2))
    assert [item.model.id for item, _ in one.objects[0]] == [item.model.id for item, _ in again.objects[0]]
