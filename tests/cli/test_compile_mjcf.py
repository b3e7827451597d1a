"""`home-mjx compile --mjcf` with both kinds of collision."""

import json

import mujoco
import numpy as np
import pytest
from generated import generate_flats

from home_mjx.cli import main
from home_mjx.geometry.meshes import box_triangles


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    root = tmp_path_factory.mktemp("houses")
    return root, generate_flats(root, [0])[0]


def hull_of(box):
    return box_triangles(box.mean(axis=0), np.maximum(np.ptp(box, axis=0) / 2, 0.01))


@pytest.mark.parametrize("collision", ["box", "exact"])
def test_model_opens_and_collides_as_asked(dataset, tmp_path, collision, monkeypatch):
    # CoACD takes minutes for a whole house; how it cuts is tested elsewhere.
    monkeypatch.setattr("home_mjx.scene_compile.mjcf.assets.convex_pieces", lambda model: (hull_of(model.box),))
    root, house = dataset
    arguments = ["compile", house, "--dataset", str(root), "--mjcf", str(tmp_path), "--collision", collision]
    assert main(arguments) == 0
    model = mujoco.MjModel.from_xml_path(str(tmp_path / house / "house.xml"))
    solid = (model.geom_contype > 0) & (model.geom_type == mujoco.mjtGeom.mjGEOM_MESH)
    assert solid.any() == (collision == "exact")
    if collision == "exact":
        assert all(
            {"object", "shift", "excluded"} == set(e)
            for e in json.loads((tmp_path / house / "overlaps.json").read_text())
        )


def test_unknown_collision_is_refused_before_anything_is_written(dataset, tmp_path, capsys):
    root, house = dataset
    arguments = ["compile", house, "--dataset", str(root), "--mjcf", str(tmp_path / "out"), "--collision", "exakt"]
    assert main(arguments) == 2
    assert "Did you mean `exact`" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
