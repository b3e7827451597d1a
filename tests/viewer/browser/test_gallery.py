"""Houses side by side: places, findings where they are, and the page's cards and plans."""

import io
import json
import threading

import numpy as np
import pytest

pytest.importorskip("viser", reason="needs the extra `view`")

from generated import flat_id, generate_flats
from handmade import shoebox
from PIL import Image
from websockets.sync.client import connect

from home_mjx.bank.bank import HouseBank
from home_mjx.cli import main
from home_mjx.datasets import ValidationFinding
from home_mjx.datasets.registry import open_dataset
from home_mjx.houses.house_set import HouseSet
from home_mjx.viewer.browser.live_camera import PictureOptions
from home_mjx.viewer.browser.run import ViewOptions
from home_mjx.viewer.gallery.findings import place_findings
from home_mjx.viewer.gallery.layout import GAP, find_boxes, look_at, place_side_by_side
from home_mjx.viewer.gallery.viewer import GalleryViewer
from home_mjx.viewer.pictures.top_view import VIEW_MARGIN


def test_houses_do_not_overlap_and_are_near():
    rng = np.random.default_rng(0)
    low = rng.uniform(-9, 9, (7, 2))
    boxes = np.stack([low, low + rng.uniform(3, 12, (7, 2))], axis=1)
    moved = boxes + place_side_by_side(boxes)[:, None]
    for a in range(7):
        for b in range(a):
            gap = np.maximum(moved[a, 0] - moved[b, 1], moved[b, 0] - moved[a, 1])
            assert gap.max() >= GAP - 1e-9
    assert np.ptp(moved, axis=(0, 1)).max() < 3 * (12 + GAP)


@pytest.fixture(scope="module")
def narrow() -> HouseBank:
    """Return two rooms around the origin, of 8 x 18 m and 18 x 8 m."""
    return HouseBank.from_compiled([shoebox((8.0, 18.0, 3.0)), shoebox((18.0, 8.0, 3.0))])


def test_boxes_of_narrow_houses_are_around_their_rooms(narrow):
    half = np.array([[4.0, 9.0], [9.0, 4.0]]) + VIEW_MARGIN
    boxes = find_boxes(narrow)
    np.testing.assert_allclose(boxes, np.stack([-half, half], axis=1), atol=float(narrow.spec.cell) + 1e-6)
    np.testing.assert_allclose(look_at(boxes[0])[1], 0.0, atol=float(narrow.spec.cell))


def test_a_plan_is_that_of_the_house_it_was_drawn_for(narrow, monkeypatch):
    with GalleryViewer(narrow, ViewOptions(port=0, picture=PictureOptions(size=32))) as viewer:
        see, is_drawing, may_end = viewer._see, threading.Event(), threading.Event()

        def see_slowly(bank, house, camera):
            is_drawing.set()
            assert may_end.wait(60)
            return see(bank, house, camera)

        monkeypatch.setattr(viewer, "_see", see_slowly)
        drawing = threading.Thread(target=viewer._draw)
        drawing.start()
        assert is_drawing.wait(60)
        viewer._chosen = 1  # as a page does meanwhile
        may_end.set()
        drawing.join()
        monkeypatch.setattr(viewer, "_see", see)
        viewer._draw()
        plans = [np.asarray(Image.open(io.BytesIO(viewer._pictures[house])), float).sum(axis=2) for house in (0, 1)]
        contrasts = [(plan.sum(axis=1).std(), plan.sum(axis=0).std()) for plan in plans]  # of rows, and of columns
        assert contrasts[0][0] < contrasts[0][1]  # upright: its columns differ
        assert contrasts[1][0] > contrasts[1][1]


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("flats")
    generate_flats(root, [0])
    return root


@pytest.fixture(scope="module")
def compiled(root):
    return HouseSet(str(root), (flat_id(0),)).load()[0]


def test_findings_are_where_their_objects_are(root, compiled):
    house = open_dataset(root).load_house(flat_id(0))
    rows = {number: row for row, number in enumerate(compiled.instances.object_id.tolist()) if number >= 0}
    nodes = [node for node in house.levels[0].objects if node.index in rows]  # of a house with one level
    findings = [ValidationFinding("house.json", f"{node.path}.bbox", "bbox-mismatch", "0.5 m off") for node in nodes]
    placed = place_findings(house, findings, compiled.offset)
    poses = [compiled.instances.pose[rows[node.index]] for node in nodes]
    models = [compiled.models[compiled.instances.model[rows[node.index]]] for node in nodes]
    middles = np.array(
        [pose[:, :3] @ np.mean(m.box, axis=0) + pose[:, 3] for pose, m in zip(poses, models, strict=True)]
    )
    away = np.linalg.norm(np.array([one.place for one in placed]) - middles, axis=1)
    assert len(away) > 20
    assert np.mean(away < 0.05) > 0.8  # boxes of doors are those of the frame, too
    assert away.max() < 1.0


def test_findings_of_rooms_and_files(root, compiled):
    house = open_dataset(root).load_house(flat_id(0))
    room = house.levels[0].rooms[0].path
    findings = [
        ValidationFinding("", f"{room}.modelId", "missing-part", ""),
        ValidationFinding("", "levels", "no-room", ""),
    ]
    of_room, of_house = place_findings(house, findings, compiled.offset)
    polygon = compiled.rooms.polygon[0]
    assert of_room.place is not None
    assert (of_room.place[:2] > polygon.min(axis=0)).all()
    assert (of_room.place[:2] < polygon.max(axis=0)).all()
    assert of_house.place is None


def test_the_page_of_houses_has_plans_and_findings(root, compiled):
    bank = HouseBank.from_compiled([compiled, compiled])
    house = open_dataset(root).load_house(compiled.id)
    finding = ValidationFinding(
        "house.json", house.levels[0].rooms[0].path, "missing-part", "no walls <img src=x onerror=f()>"
    )
    placed = {compiled.id: place_findings(house, [finding], compiled.offset)}
    with GalleryViewer(bank, ViewOptions(port=0, picture=PictureOptions(size=64)), placed) as viewer:
        viewer.choose(viewer._names[0])
        with connect(f"ws://localhost:{viewer.server.port}/live") as page:
            assert json.loads(page.recv(10))["instruction"] == "2 houses side by side"
            while isinstance(data := page.recv(10), str):
                pass
        picture = np.asarray(Image.open(io.BytesIO(data)), float)
        assert picture.shape == (64, 64, 3)
        assert picture.std() > 20
        assert "| findings | 1 |" in viewer._figures.content
        assert "missing-part" not in viewer._figures.content
        assert "no walls" in viewer._figures.content
        assert "<img" not in viewer._figures.content


@pytest.mark.parametrize("option", [["--agent", "expert"], ["--split", "val"], ["--env", "max_bodies=4"]])
def test_options_of_episodes_are_refused(option, capsys):
    assert main(["view", "procedural:2?preset=flat", "--gallery", *option]) == 2
    assert f"has no use for {option[0]}" in capsys.readouterr().err
