"""Files of scenes of other simulators as inputs of the fuzzer: Habitat, scans, 3D-FRONT, glTF, MJCF and ProcTHOR."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

Read = Callable[[bytes], object]
Prepare = Callable[[Path], tuple[list[bytes], Read]]
HOUSE_FILE = b"""ASCII 1.1
H flat flat 1 1 1 1 1 1 1 1 1 1 1 0 0 0 8 -4 3 0 0 0 0 0
R 0 0 0 0 k 2 -2 0 0 0 0 8 -4 3 2.5 0 0 0 0
S 0 0 0 f 2 -2 0 0 0 1 0 0 0 8 -4 3
V 0 0 f 0 0 0 0 0 1
V 1 0 f 4 0 0 0 0 1
V 2 0 f 4 -4 0 0 0 1
C 1 7 dining#chair 3 chair
O 4 0 1 1 -1 0 1 0 0 0 1 0 1 1 1 0
"""
COLORS_FILE = b'HM3D Semantic Annotations\n1,FF0000,"wall",0\n2,0080FF,"armchair",0\n3,010203,"table, round",1\n'
PLY_HEAD = b"""ply
format binary_little_endian 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
property int object_id
end_header
"""


def reader_of(path: Path, read: Callable[[], object]) -> Read:
    """Writes the input to a file and reads it."""

    def reader(data: bytes) -> object:
        path.write_bytes(data)
        return read()

    return reader


def habitat_file(name: str) -> Prepare:
    """A file of a Habitat dataset: the house that uses it is read."""

    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from habitat_files import write_dataset

        from home_mjx.datasets.registry import open_dataset

        os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
        config = write_dataset(folder / "data")
        path = folder / "data" / name

        def read() -> object:
            dataset = open_dataset(f"habitat:{config}")
            return [dataset.load_house(house_id) for house_id in dataset.house_ids[:1]]

        return [path.read_bytes()], reader_of(path, read)

    return prepare


def urdf(folder: Path) -> tuple[list[bytes], Read]:
    from habitat_files import CUPBOARD

    from home_mjx.datasets.habitat.articulated import ArticulatedReader
    from home_mjx.datasets.habitat.assets import AssetStore
    from home_mjx.datasets.habitat.urdf import read_urdf

    path = folder / "cupboard.urdf"

    def read() -> object:
        return ArticulatedReader(read_urdf(path), folder, AssetStore(folder, False), False).read("unknown")

    return [CUPBOARD.encode()], reader_of(path, read)


def house_file(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.datasets.habitat.matterport import read_house_file

    path = folder / "flat.house"
    return [HOUSE_FILE], reader_of(path, lambda: read_house_file(path, np.eye(4)))


def colors_file(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.datasets.habitat.scans import read_hm3d_text

    path = folder / "flat.semantic.txt"
    return [COLORS_FILE], reader_of(path, lambda: read_hm3d_text(path))


def labelled_ply(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.datasets.habitat.matterport import read_labelled_ply

    path = folder / "flat.ply"
    rows = np.arange(9, dtype="<f4").tobytes() + b"\x03" + np.array([0, 1, 2, 7], "<i4").tobytes()
    return [PLY_HEAD + rows], reader_of(path, lambda: read_labelled_ply(path, np.eye(4)))


def front(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.datasets.registry import open_dataset

    os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
    path = folder / "data" / "flat.json"
    path.parent.mkdir()
    corners, faces = [0, 0, 0, 0, 0, 4, 4, 0, 4, 4, 0, 0], [0, 1, 2, 0, 2, 3]
    meshes = [{"uid": "f", "type": "Floor", "xyz": corners, "faces": faces, "uv": [0] * 8, "material": "m"}]
    chair = {"uid": "c", "valid": True, "jid": "abc", "category": "Dining Chair", "size": [0.5, 0.9, 0.4]}
    children = [{"ref": "f"}, {"ref": "c", "pos": [1, 0, 2], "rot": [0, 0, 0, 1], "scale": [1, 1, 1]}]
    room = {"type": "Kitchen", "instanceid": "a", "children": children}
    material = [{"uid": "m", "color": [255, 0, 51, 255]}]
    house = {"furniture": [chair], "mesh": meshes, "material": material, "scene": {"room": [room]}}

    def read() -> object:
        dataset = open_dataset(f"front:{path}")
        return dataset.load_house("flat")

    return [json.dumps(house).encode()], reader_of(path, read)


def scene_file(scheme: str, name: str, data: Callable[[Path], bytes]) -> Prepare:
    """A scene in one file: its house is read."""

    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from home_mjx.datasets.registry import open_dataset

        os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
        path = folder / "data" / name
        path.parent.mkdir()

        def read() -> object:
            dataset = open_dataset(f"{scheme}:{path}")
            return dataset.load_house(dataset.house_ids[0])

        return [data(path)], reader_of(path, read)

    return prepare


def glb(path: Path) -> bytes:
    from gltf_files import two_rooms

    return two_rooms().write(path).read_bytes()


def mjcf(path: Path) -> bytes:
    from gltf_files import BOXES

    geoms = []
    for name, (low, high) in BOXES.items():
        middle, half = (np.array(low) + high) / 2, (np.array(high) - low) / 2
        size, place = (" ".join(f"{v[i]:.3f}" for i in (0, 2, 1)) for v in (half, middle * [1, 1, -1]))
        geoms.append(f'<geom name="{name}" type="box" size="{size}" pos="{place}"/>')
    joint = '<joint type="slide" axis="0 -1 0" range="0 .3"/><geom type="box" size=".2 .02 .1"/>'
    body = f'<body name="dresser" pos="2 -3 .4"><geom type="box" size=".3 .3 .3"/><body>{joint}</body></body>'
    return f"<mujoco><worldbody>{''.join(geoms)}{body}</worldbody></mujoco>".encode()


def procthor(path: Path) -> bytes:
    from thor_houses import write_house

    return write_house(path.parent, name=path.name).read_bytes()


def habitat_episodes(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.adapters.habitat import read_dataset

    pose = {"start_position": [0, 0, 0], "start_rotation": [0, 0, 0, 1], "info": {"geodesic_distance": 1.0}}
    goals = [{"position": [1, 0, 2], "radius": None}]
    episode = {"episode_id": "0", "scene_id": "a.glb", **pose, "goals": goals, "object_category": None}
    path = folder / "val.json"
    return [json.dumps({"episodes": [episode]}).encode()], reader_of(path, lambda: read_dataset(path))


def rearrangement(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.adapters.habitat import read_rearrangement

    matrix = [[0, 0, 1, 2], [0, 1, 0, 0.9], [-1, 0, 0, -3], [0, 0, 0, 1]]
    pose = {"start_position": [0, 0, 0], "start_rotation": [0, 0, 0, 1], "ao_states": {"fridge": {"2": 1.5}}}
    things = {"rigid_objs": [["bowl.json", matrix]], "targets": {"bowl": matrix}}
    path = folder / "rearrange.json"

    def read() -> object:
        dataset = read_rearrangement(path)
        return [(episode.object_poses(), episode.target_poses()) for episode in dataset.episodes]

    text = json.dumps({"episodes": [{"episode_id": 7, "scene_id": "a.json", **pose, **things}]})
    return [text.encode()], reader_of(path, read)
