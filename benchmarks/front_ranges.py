"""Sweep of fronts and drawers in generated homes: C MuJoCo moves each part of each home through its range.

    python benchmarks/front_ranges.py "procedural:20?seed=9000&preset=flat" --max-fronts 24 >> results.jsonl

For each home it prints one line: numbers of fronts, drawers and compartments, and how much deeper a part is in a fixed
box than when it is shut (`hinges`, `drawers` [m]): maxima over all parts and all steps of their ranges. Hinged fronts
turn about an edge and may be deeper in what they touch when shut by their thickness.
"""

import argparse
import json
import time
from typing import Any

import mujoco
import numpy as np

from home_mjx.datasets.furniture import attach_joints
from home_mjx.datasets.registry import open_dataset
from home_mjx.scene_compile import compile_house
from home_mjx.scene_compile.mjcf.export import instance_name, to_mjcf
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions
from home_mjx.schema.compiled import CompiledHouse

STEPS = 24  # poses of each part
LEAF = 1 << 4  # collision mask of leaves and static boxes, which do not collide in the export
COUNTS = ("fronts", "drawers", "blocked_fronts", "compartments", "shut_joints", "colliders")


def main() -> None:
    """Print a line per home, then the maxima of all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("houses")
    parser.add_argument("--max-fronts", type=int, default=24)
    args = parser.parse_args()
    dataset, rows = open_dataset(args.houses), []
    options = CompileOptions(articulation=ArticulationOptions(args.max_fronts))
    for house_id in dataset.house_ids:
        start = time.perf_counter()
        house = compile_house(attach_joints(dataset.load_house(house_id), dataset.joints), dataset.metadata, options)
        row = {"house": house_id, **{name: house.report[name] for name in COUNTS}, **sweep(house)}
        rows.append(row)
        print(json.dumps(row | {"seconds": round(time.perf_counter() - start, 2)}), flush=True)
    total: dict[str, Any] = {name: sum(row[name] for row in rows) for name in COUNTS}
    total |= {name: max(row[name] for row in rows) for name in ("hinges", "drawers_deeper")}
    print(json.dumps({"homes": len(rows), **total}))


def sweep(house: CompiledHouse) -> dict[str, float]:
    """Return how much deeper hinged fronts and drawers are in fixed boxes on their way than when they are shut [m]."""
    model = mujoco.MjModel.from_xml_string(*to_mjcf(house))  # pyright: ignore[reportAttributeAccessIssue]
    data = mujoco.MjData(model)  # pyright: ignore[reportAttributeAccessIssue]
    names = [model.geom(g).name for g in range(model.ngeom)]
    static = np.array([name.startswith("static") for name in names])
    deepest = {"hinges": 0.0, "drawers_deeper": 0.0}
    for row in np.flatnonzero(house.doors.is_front).tolist():
        name = instance_name(house, int(house.doors.instance[row]))
        own = np.array([n == name or n.startswith(f"{name}_tray") for n in names])
        model.geom_contype[:], model.geom_conaffinity[:] = np.where(own, LEAF, 0), np.where(static, LEAF, 0)
        model.body_contype[:] = model.body_conaffinity[:] = LEAF  # the broad phase's own masks
        ways = np.linspace(house.doors.closed[row], house.doors.fully_open[row], STEPS)
        depths = [_depths(model, data, model.joint(name).qposadr[0], way) for way in ways]
        kind = "drawers_deeper" if house.doors.is_sliding[row] else "hinges"
        deeper = (depth - depths[0].get(box, 0.0) for there in depths for box, depth in there.items())
        deepest[kind] = max(deepest[kind], *deeper, 0.0)
    return {name: round(value, 5) for name, value in deepest.items()}


def _depths(model: Any, data: Any, address: int, way: float) -> dict[tuple[int, ...], float]:
    """Return the maximum depth of each pair of a part's box and a fixed box at a joint coordinate [m]."""
    data.qpos[:] = model.qpos0
    data.qpos[address] = way
    mujoco.mj_kinematics(model, data)  # pyright: ignore[reportAttributeAccessIssue]
    mujoco.mj_collision(model, data)  # pyright: ignore[reportAttributeAccessIssue]
    found: dict[tuple[int, ...], float] = {}
    for contact in data.contact:
        pair = tuple(contact.geom.tolist())
        found[pair] = max(found.get(pair, 0.0), -float(contact.dist))
    return found


if __name__ == "__main__":
    main()
