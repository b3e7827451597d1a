"""Joints of the furniture of homes: true of the shapes, in the order of the files, and on disk as they were made."""

import hashlib
import json
import re
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from moved_parts import depths, pieces

from home_mjx.cli import main
from home_mjx.datasets import open_dataset, validate_house
from home_mjx.datasets.suncg.digests import SuncgDigests
from home_mjx.datasets.suncg.formats.obj import read_obj
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.datasets.suncg.write.house import write_joints
from home_mjx.datasets.suncg.write.obj import mtl_text, obj_text
from home_mjx.errors import ConfigError
from home_mjx.schema.house import Joint, Mesh
from home_procgen import generate_dataset
from home_procgen.model_library import table_rows
from home_procgen.model_store import library
from home_procgen.primitives.solids import box, move, rotate
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.movable_parts import assign_part, front_part

CLEAR = 0.01  # [m]: by so much a part may cut into its model, or by as much as it does where it is drawn
UNDER = {"home_kitchen_cabinet_7", "home_bunker_bed_2", "home_desk_4"}  # drawers below something that reaches over them
JOINTED = [model for model in library().values() if model.joints]
ANY = [(model.id, joint) for model in JOINTED for joint in model.joints]


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    """Meshes of models as read from their files, without pictures."""
    folder = tmp_path_factory.mktemp("models")

    @cache
    def model(model_id: str) -> Mesh:
        mesh = library()[model_id].mesh
        (folder / f"{model_id}.obj").write_text(obj_text(mesh, f"{model_id}.mtl"))
        plain = "\n".join(line for line in mtl_text(mesh.materials).splitlines() if not line.startswith("map_Kd"))
        (folder / f"{model_id}.mtl").write_text(plain)
        return read_obj(folder / f"{model_id}.obj", TextureLookup(folder))

    return model


def without_axis(points: np.ndarray, joint: Joint) -> np.ndarray:
    """Vectors from the axis of a hinge to points, upright to it [m]."""
    away = points - joint.point
    return away - np.outer(away @ joint.axis, joint.axis)


def test_parts_are_whole_closed_pieces_and_share_no_face(read):
    for model in JOINTED:
        mesh = read(model.id)
        piece, taken = pieces(mesh), np.zeros(len(mesh.faces), int)
        for joint in model.joints:
            taken[joint.faces] += 1
            assert not np.isin(piece[np.setdiff1d(np.arange(len(piece)), joint.faces)], piece[joint.faces]).any()
            sides = np.sort(mesh.faces[joint.faces][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
            assert (np.unique(sides, axis=0, return_counts=True)[1] % 2 == 0).all(), (model.id, joint.part)
        assert taken.max() == 1
        assert 0 in taken  # something stays


def test_faces_in_the_order_of_the_file_are_those_of_the_solids(read):
    """The box of what the file calls the first drawer is where the chest of drawers draws one."""
    dresser = library()["home_dresser_1"]
    mesh, joint = read(dresser.id), dresser.joints[0]
    corners = mesh.vertices[np.unique(mesh.faces[joint.faces])]
    assert joint.part == "drawer_1"
    assert np.ptp(corners[:, 0]) == pytest.approx((1.2 - 0.02) / 2 - 0.005, abs=1e-5)
    assert np.ptp(corners[:, 1]) == pytest.approx((0.85 - 0.17) / 3 - 0.005, abs=1e-5)
    assert {mesh.materials[k].name for k in mesh.slot[joint.faces]} == {
        f"material_{k}" for k, name in enumerate(dresser.slots) if name in ("wood_1", "brass")
    }


def test_axes_lie_at_an_edge_of_their_part(read):
    for model_id, joint in ANY:
        mesh = read(model_id)
        points = mesh.vertices[np.unique(mesh.faces[joint.faces])]
        assert np.linalg.norm(joint.axis) == pytest.approx(1.0, abs=2e-6)
        if joint.kind == "slide":
            assert (points.min(0) - 1e-5 <= joint.point).all()
            assert (np.array(joint.point) <= points.max(0) + 1e-5).all()
            continue
        away = without_axis(points, joint)
        radius = np.linalg.norm(away, axis=1)
        assert radius.min() < 0.012 or model_id in ("home_refrigerator_3", "home_coffee_table_6"), model_id  # round
        assert radius.min() < 0.025
        # All of the part is to one side: seen along the axis, what is far from it is in one quarter.
        far = away[radius > 0.6 * radius.max()]
        middle = far.mean(0) / np.linalg.norm(far.mean(0))
        assert (far @ middle > 0.8 * np.linalg.norm(far, axis=1)).all(), (model_id, joint.part)


def test_drawers_slide_along_the_normal_of_their_front(read):
    for model_id, joint in ANY:
        if joint.kind == "slide":
            mesh = read(model_id)
            corners = mesh.vertices[mesh.faces[joint.faces]]
            area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
            size = np.linalg.norm(area, axis=1)
            fronts = size[area @ joint.axis > 0.9 * size].sum()
            assert joint.part.startswith("drawer_")
            assert fronts > 0.1 * size.sum(), model_id
            assert 0.1 <= joint.high <= 0.6


def test_parts_open_outwards(read):
    """What opens forward comes out of the box of the rest, lids rise."""
    inwards = set()
    for model_id, joint in ANY:
        mesh, moved = read(model_id), joint.move(read(model_id), joint.high)
        own = np.unique(mesh.faces[joint.faces])
        rest = np.delete(mesh.vertices, own, 0)
        low, high = rest.min(0), rest.max(0)
        middles = (each.vertices[own].mean(0) for each in (mesh, moved))
        before, after = (np.linalg.norm(np.maximum(np.maximum(low - at, at - high), 0)) for at in middles)
        if joint.part.startswith("lid"):
            assert (moved.vertices - mesh.vertices)[own, 1].mean() > 0.05
        elif after < before + 0.03:
            inwards.add(model_id)
    assert inwards == UNDER


def check_clear(read, models, steps: int) -> None:
    found = [(m.id, j.part, depths(read(m.id), j, steps)) for m in models for j in m.joints]
    assert [(name, part, max(d)) for name, part, d in found if max(d) > max(CLEAR, d[0] + 0.001)] == []


def test_parts_move_clear_of_the_rest_of_their_model(read):
    check_clear(read, JOINTED[::5], 5)


@pytest.mark.slow
def test_parts_of_all_models_move_clear_of_the_rest_all_the_way(read):
    check_clear(read, JOINTED, 33)


def test_at_0_nothing_has_moved_and_only_the_part_moves(read):
    for model_id, joint in ANY:
        mesh = read(model_id)
        np.testing.assert_allclose(joint.move(mesh, 0.0).vertices, mesh.vertices, atol=1e-12)
        moved = joint.move(mesh, joint.high)
        changed = np.abs(moved.vertices - mesh.vertices).max(1) > 1e-9
        assert set(np.flatnonzero(changed)) <= set(np.unique(mesh.faces[joint.faces]))
        assert moved.normal is not None
        assert mesh.normal is not None
        rest = np.setdiff1d(np.arange(len(mesh.faces)), joint.faces)
        np.testing.assert_array_equal(moved.normal[rest], mesh.normal[rest])


def test_values_out_of_range_and_meshes_of_other_models_are_refused(read):
    joint = library()["home_dresser_1"].joints[0]
    for value in (-0.01, joint.high + 0.01, float("nan")):
        with pytest.raises(ConfigError, match="has no joint value"):
            joint.matrix(value)
    with pytest.raises(ConfigError, match="faces that the mesh lacks"):
        library()["home_refrigerator_9"].joints[-1].move(read("home_mirror_7"), 0.1)


def test_marks_go_with_solids_that_are_turned_moved_and_mirrored():
    part = front_part("left", (0.0, 0.0, 0.02), (0.4, 1.0))
    (leaf,) = assign_part(part, [box("wood", (0.4, 1.0, 0.02), (0.2, 0.0, 0.01))])
    turned = move(rotate(leaf, 1, np.pi / 2), (1.0, 2.0, 3.0)).part
    assert turned is not None
    np.testing.assert_allclose(turned.point, (1.02, 2.0, 3.0), atol=1e-12)
    np.testing.assert_allclose(turned.axis, (0.0, -1.0, 0.0), atol=1e-12)
    same, other = add_mirror_images([leaf])
    assert same.part == part
    assert other.part == front_part("right", (-0.4, 0.0, 0.02), (0.4, 1.0))


def test_most_furniture_with_fronts_has_joints():
    """The table of docs/dataset.md."""
    models = Counter(model.fine for model in library().values())
    jointed, parts = Counter(m.fine for m in JOINTED), Counter(j.part.partition("_")[0] for _, j in ANY)
    text = (Path(__file__).parents[2] / "docs" / "dataset.md").read_text()
    rows = [line for line in text.splitlines() if re.match(r"\| `\w+` \| \d+ of \d+ \|", line)]
    told = {row.split("`")[1]: row.split("|")[2].split() for row in rows}
    counted = {fine: (str(number), "of", str(models[fine])) for fine, number in jointed.items()}
    assert {fine: tuple(words) for fine, words in told.items()} == counted
    each = ", ".join(f"{parts[name]} {name}s" for name in ("door", "drawer", "flap", "lid"))
    assert f"{len(JOINTED)} of {len(library())} models have {len(ANY)} parts: {each}" in " ".join(text.split())


def digests(root: Path) -> dict[str, str]:
    files = (path for path in root.rglob("*") if path.is_file())
    return {str(path.relative_to(root)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def root(tmp_path_factory) -> Path:
    root = tmp_path_factory.mktemp("homes") / "homes"
    generate_dataset(root, [3])
    return root


def test_the_table_of_a_dataset_says_what_the_shapes_say(root):
    assert open_dataset(root).joints == {model.id: model.joints for model in JOINTED}


@pytest.mark.slow
def test_inspect_counts_the_parts_of_a_home(root, capsys):
    assert main(["inspect", "--dataset", str(root), "--json"]) == 0
    dataset = open_dataset(root)
    things = [item for level in dataset.load_house(dataset.house_ids[0]).levels for item in level.objects]
    count = sum(len(library()[item.model_id].joints) for item in things if item.model_id in library())
    assert json.loads(capsys.readouterr().out)["joints"] == count > 20


def test_a_folder_of_before_there_were_joints_gets_them_and_nothing_else(root, caplog):
    """And what is compiled from the folder stays: nothing is compiled from joints."""
    whole, house = digests(root), open_dataset(root).house_ids[0]
    key = SuncgDigests(root).house(house)
    for name in ("joints.csv", "joints.sha256.json"):
        (root / "metadata" / name).unlink()
    assert SuncgDigests(root).house(house) == key
    dataset = open_dataset(root)
    assert dataset.joints == {}
    assert validate_house(dataset, house) == ()
    generate_dataset(root, [3])
    assert digests(root) == whole
    assert not caplog.records


def test_a_broken_table_is_made_again(root):
    whole, path = digests(root), root / "metadata" / "joints.csv"
    path.write_text(path.read_text()[:500])
    generate_dataset(root, [3])
    assert digests(root) == whole


def test_the_digest_of_the_tables_is_that_of_before_there_were_joints(root):
    known = json.loads((root / "metadata" / "sha256.json").read_text())
    assert set(known) == {"ModelCategoryMapping.csv", "models.csv", "suncgModelLights.json"}


def test_joints_are_written_alike_each_time(root, tmp_path):
    (tmp_path / "metadata").mkdir()
    write_joints(tmp_path, table_rows(JOINTED))
    assert (tmp_path / "metadata" / "joints.csv").read_bytes() == (root / "metadata" / "joints.csv").read_bytes()
