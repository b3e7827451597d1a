"""Checks of generated homes, one home at a time; `benchmarks/homes.py` runs them.

Meshes are read back from the files. They are walked, hung and pushed by methods that share nothing with the generator:
those of tests/helpers, and C MuJoCo.
"""

import base64
import hashlib
import sys
import time
import zlib
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))
from standing_things import floating, overlaps, things
from walked_homes import LINKS, Home, Walker, reachable, room_map

from home_mjx.datasets import validate_house
from home_mjx.datasets.base import Dataset
from home_mjx.geometry.slabs import signed_area
from home_mjx.scene_compile import compile_house
from home_mjx.scene_compile.architecture.rooms import extract_rooms
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.mjcf.initial_overlaps import measure_rest_drift
from home_mjx.schema.categories import ROOM_TYPES
from home_procgen.presets import Variant

RADII = (0.10, 0.25)  # [m] radii of walkers
LEAST = 0.2  # [m^2] minimum area of each room that they must reach
TORQUE, PUSHED = 4.0, 4.0  # [N m] torque at doors, and its duration in each direction [s]

Record = dict[str, Any]


def check_home(dataset: Dataset, seed: int, thorough: bool) -> Record:
    """Read a home from its files and check it.

    Args:
        dataset: Dataset with the home.
        seed: Seed of the home.
        thorough: Also walk it with two radii, compile it, push its doors, and simulate it for ten seconds at rest.
    """
    times, start = {}, time.perf_counter()

    def lap(name: str) -> None:
        nonlocal start
        times[name] = round(time.perf_counter() - start, 3)
        start = time.perf_counter()

    name = Variant().house_id(seed)
    home = Home(dataset.load_house(name), dataset.metadata)
    lap("read")
    found: Record = {"seed": seed, "sha256": digest(dataset.root, name)}
    found["findings"] = [str(finding) for finding in validate_house(dataset, name)]
    lap("validate")
    found |= doors(home) | standing(home)
    lap("look")
    found |= statistics(home)
    lap("count")
    if thorough:
        walker = Walker(home)
        found["unreached"] = {str(r): [str(k) for k, a in walker.reached(r).items() if a < LEAST] for r in RADII}
        lap("walk")
        compiled = compile_house(home.house, dataset.metadata)
        lap("compile")
        xml, files = to_mjcf(compiled)
        found["hinges"], found["stuck"] = len(compiled.doors.mass), stuck(xml, files)
        lap("push")
        found["free"], found["drift"] = (
            len(compiled.bodies.mass),
            max(measure_rest_drift(xml, files).values(), default=0.0),
        )
        lap("rest")
    return found | {"times": times}


def digest(root: Path, name: str) -> str:
    """Return the digest of a home's files."""
    total = hashlib.sha256()
    for path in (*sorted((root / "room" / name).iterdir()), root / "house" / name / "house.json"):
        total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()


def doors(home: Home) -> Record:
    """Find private rooms without exactly one neighbour, entrances, and rooms not reachable through common ones."""
    joined, entrances = home.graph(), home.entrances()
    private = [home.kind(*room) for room in home.rooms() if home.kind(*room) not in LINKS and len(joined[room]) != 1]
    got = reachable(joined, entrances[0], lambda room: home.kind(*room) in LINKS) if entrances else set()
    return {"links": private, "entrances": len(entrances), "shut": [str(r) for r in set(home.rooms()) - got]}


def standing(home: Home) -> Record:
    """Find floating objects, and pairs that interpenetrate by more than 5 mm."""
    floats, pairs = [], []
    for level in range(len(home.house.levels)):
        found = things(home, level)
        floats += floating(home, level, found)
        pairs += overlaps(found)
    return {"floating": floats, "overlaps": pairs}


def statistics(home: Home) -> Record:
    """Count types and areas of rooms, and objects by fine class and room type; pack the ground floor's room map."""
    rooms = extract_rooms(home.house, np.zeros(3))
    held: dict[str, list[str]] = {}
    for level in home.house.levels:
        infos = {item.index: home.metadata.info(item.model_id) for item in level.objects}
        for room in level.rooms:
            for info in (infos[i] for i in room.members if i in infos):
                held.setdefault(room.types[0], []).append(f"{info.fine}/{info.coarse}/{info.model_id}")
    grid = room_map(home).astype(np.uint8)
    return {
        "storeys": len(home.house.levels),
        "floors": [len(level.rooms) for level in home.house.levels],
        "objects": [len(room.members) for level in home.house.levels for room in level.rooms],
        "rooms": [ROOM_TYPES[kind] for kind in rooms.type.tolist()],
        "areas": [round(float(signed_area(polygon)), 2) for polygon in rooms.polygon],
        "held": held,
        "map": [*grid.shape, base64.b64encode(zlib.compress(grid.tobytes())).decode()],
    }


def unpacked(entry: list[Any]) -> np.ndarray:
    """Unpack the room map of a record."""
    high, wide, text = entry
    return np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8).reshape(high, wide).astype(int)


def stuck(xml: str, files: dict[str, bytes]) -> list[str]:
    """Find doors with less than nine tenths of their range when pushed both ways, and doors without a range."""
    model = mujoco.MjModel.from_xml_string(xml, dict(files))
    data = mujoco.MjData(model)
    hinges = [j for j in range(model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE and model.jnt_limited[j]]
    at, axis = model.jnt_qposadr[hinges], model.jnt_dofadr[hinges]
    seen = [data.qpos[at].copy()]
    for way in (1, -1):
        for _ in range(round(PUSHED / model.opt.timestep)):
            data.qfrc_applied[axis] = way * TORQUE
            mujoco.mj_step(model, data)
        seen.append(data.qpos[at].copy())
    low, high = np.min(seen, axis=0), np.max(seen, axis=0)
    width = np.ptp(model.jnt_range[hinges], axis=1)
    bad = (high - low < 0.9 * width) | (width < 0.5)
    return [f"{model.joint(hinges[i]).name}: {high[i] - low[i]:.2f} of {width[i]:.2f}" for i in np.flatnonzero(bad)]
