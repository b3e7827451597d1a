"""Depth and segmentation of an exported house are those of MuJoCo's own renderer, where there is an OpenGL to ask."""

import json
import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import camera_quat
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_scene

SIZE = (96, 72)
FOVY = 70.0
FURNITURE = (
    Furniture((0.8, 1.2), (0.6, 0.9, 0.7), yaw=0.5),
    Furniture((-1.4, 0.9), (0.4, 0.4, 1.9), yaw=-0.2),
    Furniture((0.0, 2.0), (1.6, 0.5, 0.4)),
)
SCRIPT = """
import json, sys
import mujoco, numpy as np
spec = json.load(sys.stdin)
boxes = "".join(
    f'<geom type="box" pos="{p[0]} {p[1]} {p[2]}" size="{s[0]} {s[1]} {s[2]}" euler="0 0 {y}"/>'
    for p, s, y in spec["boxes"]
)
model = mujoco.MjModel.from_xml_string(
    f'<mujoco><compiler angle="radian"/><visual><map znear="0.001" zfar="30"/></visual><statistic extent="1"/>'
    f'<worldbody>{boxes}<camera name="eye" pos="{spec["pos"]}" quat="{spec["quat"]}" fovy="{spec["fovy"]}"/>'
    '</worldbody></mujoco>'
)
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = mujoco.Renderer(model, spec["height"], spec["width"])
renderer.update_scene(data, "eye")
renderer.enable_depth_rendering()
depth = renderer.render()
renderer.disable_depth_rendering()
renderer.enable_segmentation_rendering()
np.savez(spec["out"], depth=depth, segmentation=renderer.render()[..., 0])
"""


def mujoco_images(tmp_path, pos, quat):
    walls = [
        ((-3.05, 0, 1.5), (0.05, 2.6, 1.6), 0),
        ((3.05, 0, 1.5), (0.05, 2.6, 1.6), 0),
        ((0, -2.55, 1.5), (3.1, 0.05, 1.6), 0),
        ((0, 2.55, 1.5), (3.1, 0.05, 1.6), 0),
        ((0, 0, -0.05), (3.1, 2.6, 0.05), 0),
        ((0, 0, 3.05), (3.1, 2.6, 0.05), 0),
    ]
    things = [((*f.position, f.size[2] / 2), tuple(x / 2 for x in f.size), f.yaw) for f in FURNITURE]
    out = tmp_path / "images.npz"
    words = {"pos": " ".join(map(str, pos)), "quat": " ".join(map(str, quat))}
    spec = {"boxes": walls + things, "fovy": FOVY, "width": SIZE[0], "height": SIZE[1], "out": str(out)} | words
    environment = os.environ | {"MUJOCO_GL": os.environ.get("MUJOCO_GL", "egl")}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        input=json.dumps(spec),
        text=True,
        capture_output=True,
        env=environment,
        check=False,
    )
    if not out.exists():
        pytest.skip(f"MuJoCo cannot render here: {done.stderr.strip().splitlines()[-1:]}")
    return np.load(out)


def test_depth_and_segmentation_are_mujoco_s(tmp_path):
    pos = (-1.9, -1.7, 1.6)
    yaw, pitch = 0.95, -0.2
    quat = np.asarray(camera_quat(jnp.float32(yaw), jnp.float32(pitch)), float)
    peer = mujoco_images(tmp_path, pos, quat)
    bank = HouseBank.from_compiled([shoebox(furniture=FURNITURE)])
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    scene = make_scene(bank, jnp.int32(0), bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody)
    camera = Camera(jnp.array(pos, jnp.float32), jnp.asarray(quat, jnp.float32), jnp.float32(np.deg2rad(FOVY)))
    look = jax.jit(lambda s, c: render(s, c, Lens(*SIZE), kinds=("depth", "instance", "partition")))
    images = jax.tree.map(np.asarray, look(scene, camera))
    ours = np.where(images["instance"] >= 0, 6 + images["instance"], images["partition"])
    same = ours == peer["segmentation"]
    # A rasteriser decides by coverage rules where an edge passes a pixel's middle.
    assert same.mean() > 0.995
    assert set(np.unique(ours)) == set(np.unique(peer["segmentation"]))
    assert len(set(np.unique(ours))) >= 6
    inner = same & np.roll(same, 1, 0) & np.roll(same, 1, 1)
    np.testing.assert_allclose(images["depth"][..., 0][inner], peer["depth"][inner], rtol=2e-3)
