"""Convex pieces against the meshes that they stand for, and houses that collide by them."""

import json
import sys
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest
from handmade import Furniture, shoebox
from scipy.spatial import ConvexHull, KDTree

from home_mjx.errors import ConfigError
from home_mjx.geometry.box_fit import sample_surface
from home_mjx.geometry.meshes import bounds, box_triangles, make_model
from home_mjx.scene_compile.mjcf import convex
from home_mjx.scene_compile.mjcf.convex import convex_pieces
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.mjcf.initial_overlaps import measure_rest_drift

pytest.importorskip("coacd", reason="the extra `exact` is not installed")


@pytest.fixture(autouse=True)
def empty_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def table():
    """A top of 1.2 x 0.8 m on four legs."""
    parts = [box_triangles(np.array([0, 0, 0.72]), np.array([0.6, 0.4, 0.02]))]
    for x in (-0.55, 0.55):
        for y in (-0.35, 0.35):
            parts.append(box_triangles(np.array([x, y, 0.35]), np.array([0.03, 0.03, 0.35])))
    return make_model("table", np.concatenate(parts))


def test_pieces_of_a_table_leave_the_space_below_free():
    pieces = convex_pieces(table())
    hulls = [ConvexHull(piece.reshape(-1, 3)) for piece in pieces]

    def inside(point, slack):
        return any((hull.equations[:, :3] @ point + hull.equations[:, 3]).max() < slack for hull in hulls)

    assert not inside(np.array([0.0, 0.0, 0.35]), 0.0)
    surface = sample_surface(table().triangle.astype(float), 0.02)
    assert np.mean([inside(point, 0.015) for point in surface[::50]]) > 0.99
    corners = np.concatenate([piece.reshape(-1, 3) for piece in pieces])
    assert KDTree(surface).query(corners)[0].max() < 0.03
    np.testing.assert_allclose(bounds(corners), table().box, atol=1e-6)


def test_pieces_are_closed_and_wound_outwards():
    for piece in convex_pieces(table()):
        edges = np.sort(np.round(piece[:, [[0, 1], [1, 2], [2, 0]]], 9).reshape(-1, 2, 3), axis=1)
        volume = np.einsum("ti,ti->", piece[:, 0], np.cross(piece[:, 1], piece[:, 2])) / 6
        assert volume == pytest.approx(ConvexHull(piece.reshape(-1, 3)).volume, rel=1e-6)
        assert len(edges) % 2 == 0


def test_pieces_come_from_the_cache_and_are_the_same(monkeypatch):
    first = convex_pieces(table())
    monkeypatch.setattr(convex, "_decompose", lambda *_: pytest.fail("decomposed again"))
    again = convex_pieces(table())
    assert len(first) == len(again)
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a, b)


def test_flat_models_have_no_pieces():
    assert convex_pieces(make_model("rug", np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]]))) == ()


def test_without_coacd_the_error_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "coacd", None)
    with pytest.raises(ConfigError, match=r"pip install .*\[exact\]"):
        convex_pieces(table())


def test_unknown_collision_is_refused():
    with pytest.raises(ConfigError, match="Did you mean `exact`"):
        to_mjcf(shoebox(), collision="exakt")


# A light box 2 cm deep in a heavy one beside it, one deep in the middle of a wardrobe, one that stands free.
FURNITURE = (
    Furniture((0.0, 0.0), (0.4, 0.4, 0.4), mass=5.0),
    Furniture((0.38, 0.0), (0.4, 0.4, 0.4)),
    Furniture((-1.5, 1.0), (0.8, 0.8, 1.8)),
    Furniture((-1.5, 1.0), (0.2, 0.2, 0.3), mass=3.0),
    Furniture((1.5, -1.0), (0.4, 0.4, 0.4), mass=5.0),
)


def test_overlaps_are_parted_or_excluded_and_listed():
    xml, files = to_mjcf(shoebox(furniture=FURNITURE), collision="exact")
    found = {entry["object"]: entry for entry in json.loads(files["overlaps.json"])}
    assert found["object0"]["excluded"] == []
    assert 0.02 <= -found["object0"]["shift"][0] < 0.03
    assert found["object3"]["excluded"] == ["object2"]
    assert "object4" not in found or np.abs(found["object4"]["shift"]).max() < 0.01
    model = mujoco.MjModel.from_xml_string(xml, files)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert min(contact.dist for contact in data.contact) > -2e-3


@pytest.mark.parametrize("collision", ["box", "exact"])
def test_what_stands_stays(collision):
    drift = measure_rest_drift(*to_mjcf(shoebox(furniture=FURNITURE[4:]), collision=collision), seconds=2.0)
    assert list(drift) == ["object0"]
    assert drift["object0"] < 1e-3


def test_what_falls_is_seen_to():
    xml, files = to_mjcf(shoebox(furniture=FURNITURE[4:]))
    root = ET.fromstring(xml)
    root.find("worldbody/body[@name='object0']").set("pos", "1.5 -1 0.7")
    drift = measure_rest_drift(ET.tostring(root, encoding="unicode"), files, seconds=1.0)
    assert drift["object0"] == pytest.approx(0.5, abs=0.08)  # it dives into the soft floor first
