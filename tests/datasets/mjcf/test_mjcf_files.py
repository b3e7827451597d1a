"""MJCF files that are broken, too large, or name files outside of their root: typed errors with file and element."""

import random
from pathlib import Path

import pytest

from home_mjx.datasets.mjcf.dataset import MjcfDataset
from home_mjx.errors import DatasetError, HomeMjxError, MissingFileError

ROOM = (
    '<geom name="floor" type="box" size="2 2 .05" pos="0 0 -.05"/>'
    '<body name="stool" pos="1 0 .2"><freejoint/><geom type="box" size=".1 .1 .2" material="m"/></body>'
    '<light pos="0 0 2"/>'
)
ASSETS = '<texture name="t" type="2d" builtin="checker" width="8" height="8"/><material name="m" texture="t"/>'


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def read(path: Path, query: str = ""):
    return MjcfDataset(f"{path}{query}").load_house(path.stem)


def scene(folder: Path, *, head: str = "", assets: str = "", world: str = "", tail: str = "") -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / "room.xml"
    path.write_text(f"<mujoco>{head}<asset>{ASSETS}{assets}</asset><worldbody>{ROOM}{world}</worldbody>{tail}</mujoco>")
    return path


HILLS = '<hfield name="x" nrow="800" ncol="800" size="1 1 1 1"/>'
BIG = '<replicate count="1000"><replicate count="1000"><geom size=".1"/></replicate></replicate>'


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"assets": '<mesh name="x" file="../secret.obj"/>'}, "leads out"),
        ({"assets": '<mesh name="x" file="/etc/passwd"/>'}, "leads out"),
        ({"assets": '<mesh name="x" file="http://host/x.obj"/>'}, "expected a path"),
        ({"assets": '<mesh name="x" file="link.obj"/>'}, "leads out"),
        ({"assets": '<texture name="x" type="cube" fileup="../x.png"/>'}, "leads out"),
        ({"head": '<compiler meshdir=".."/>', "assets": '<mesh name="x" file="secret.obj"/>'}, "leads out"),
        ({"head": '<compiler assetdir="/"/>', "assets": '<mesh name="x" file="etc/passwd"/>'}, "leads out"),
        ({"world": '<geom name="wall" type="box" size=".05 335896785464 1"/>'}, "beyond 1,000 km"),
        ({"head": '<include file="../other.xml"/>'}, "leads out"),
        ({"head": '<include file="room.xml"/>'}, "includes itself"),
        ({"assets": '<model name="x" file="room.xml"/>'}, "contains itself"),
        ({"assets": '<texture name="x" type="2d" builtin="flat" width="99999" height="99999"/>'}, "texels"),
        ({"assets": '<texture name="x" type="2d" file="bomb.png"/>'}, "pixels"),
        ({"assets": '<hfield name="x" nrow="1001" ncol="1000" size="1 1 1 1"/>'}, "at most 1000000"),
        ({"assets": HILLS, "world": '<geom type="hfield" hfield="x"/>' * 2}, "1280000 heights"),
        ({"world": BIG}, "copies"),
        ({"world": '<flexcomp name="c" type="grid" count="999 999 99" spacing="1 1 1"/>'}, "copies"),
        ({"head": '<extension><plugin plugin="mujoco.sdf.bolt"/></extension>'}, "plug-ins"),
        ({"world": f"{'<body>' * 300}{'</body>' * 300}"}, "levels deep"),
        ({"world": '<body name="a" pos="nan 0 0"><geom size="1"/></body>'}, "finite|nan|NaN"),
        ({"world": '<body name="a" pos="1e30 0 0"><geom size="1"/></body>'}, "finite"),
        ({"world": '<body name="a"><geom size="-1"/></body>'}, "MuJoCo refuses"),
        ({"world": "<region/>"}, "MuJoCo refuses"),
        ({"assets": '<mesh name="x" vertex="0 0 0"/>'}, "MuJoCo refuses"),
        ({"head": '<size memory="900G"/>', "world": "<geom/>"}, "MuJoCo refuses"),
    ],
)
def test_scenes_that_are_refused(tmp_path, parts, message):
    path = scene(tmp_path / "scene", **parts)
    (tmp_path / "secret.obj").write_text("v 0 0 0\n")
    (tmp_path / "scene" / "link.obj").symlink_to(tmp_path / "secret.obj")
    bomb = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + (60_000).to_bytes(4, "big") * 2
    (tmp_path / "scene" / "bomb.png").write_bytes(bomb)
    with pytest.raises(DatasetError, match=message) as caught:
        read(path)
    assert caught.value.file
    assert not isinstance(caught.value, MissingFileError)


@pytest.mark.parametrize("text", ["", "<mujoco>", "<robot/>", '<!DOCTYPE a [<!ENTITY b "c">]><mujoco/>', "\0", "{}"])
def test_files_that_are_no_mjcf(tmp_path, text):
    path = tmp_path / "odd.xml"
    path.write_text(text)
    with pytest.raises(DatasetError) as caught:
        read(path)
    assert caught.value.file == str(path)


def test_a_package_may_name_files_of_its_other_folders(tmp_path):
    """The licence marks the package's folder; without one, the option `root` does."""
    folder = tmp_path / "package" / "scene"
    folder.parent.mkdir()
    (tmp_path / "package" / "part.xml").write_text('<mujocoinclude><geom name="x" size=".1"/></mujocoinclude>')
    path = scene(folder, world='<body name="vase" pos="0 0 1"><include file="../part.xml"/></body>')
    with pytest.raises(DatasetError, match="leads out"):
        read(path)
    before = MjcfDataset(f"{path}?root={folder.parent}").inputs().house("room")
    assert read(path, f"?root={folder.parent}").levels
    (folder.parent / "LICENSE").write_text("MIT")
    objects = [o.model_id for o in read(path).levels[0].objects]
    assert "vase" in objects
    (folder.parent / "part.xml").write_text('<mujocoinclude><geom name="x" size=".2"/></mujocoinclude>')
    assert MjcfDataset(f"{path}?root={folder.parent}").inputs().house("room") != before


def test_damaged_scenes_are_read_or_refused_by_typed_errors(tmp_path):
    path = scene(tmp_path / "scene", head='<compiler angle="radian"/>', tail="<actuator/>")
    whole, outcomes = path.read_bytes(), set()
    for number in range(150):
        rng, data = random.Random(number), bytearray(whole)
        for _ in range(rng.choice((1, 1, 3))):
            data[rng.randrange(len(data))] = rng.choice(b'\0"<>/0123456789abcdefghinx -e.&')
        path.write_bytes(bytes(data[: rng.randrange(len(data))] if rng.random() < 0.1 else data))
        try:
            outcomes.add(type(read(path)).__name__)
        except HomeMjxError as error:
            outcomes.add(type(error).__name__ if error.file else "no file")
    assert {"House", "DatasetError"} <= outcomes <= {"House", "DatasetError", "MissingFileError"}
