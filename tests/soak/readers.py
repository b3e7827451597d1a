"""All that the package reads from files, as targets of the fuzzer: good inputs, and how one is read."""

import io
import json
import logging
import os
import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from asset_readers import DAE, PLY, STL, binary_ply, binary_stl, parts, plain, usd
from mutations import Mutation, of_archive, of_bytes, of_json, of_json_lines, of_png, of_text
from scene_readers import (
    colors_file,
    front,
    glb,
    habitat_episodes,
    habitat_file,
    house_file,
    labelled_ply,
    mjcf,
    procthor,
    rearrangement,
    scene_file,
    urdf,
)

from home_mjx.errors import HomeMjxError

Read = Callable[[bytes], object]


class Remade(Exception):
    """An entry of the cache was found broken, and would be made again."""


@dataclass(frozen=True)
class Target:
    """A reader.

    Attributes:
        prepare: From a folder of its own to good inputs and what reads one; run in the process that reads.
        kinds: Ways in which inputs are changed.
        refusals: What a reader may raise.
        quick: Whether it is ready within a second or two: no program is compiled.
    """

    prepare: Callable[[Path], tuple[list[bytes], Read]]
    kinds: tuple[Mutation, ...]
    refusals: tuple[type[BaseException], ...] = (HomeMjxError,)
    quick: bool = True


def file_reader(path: Path, read: Callable[[], object]) -> Read:
    """Writes the input to a file and reads it."""

    def reader(data: bytes) -> object:
        path.write_bytes(data)
        return read()

    return reader


# SUNCG


def dataset_file(name: str, house: str = "v1") -> Callable[[Path], tuple[list[bytes], Read]]:
    """A file of a dataset: the house that uses it is read, and its textures are decoded."""

    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from fuzz_corpus import DOOR, HOUSE_ID, TABLE, V2_ID, load_and_decode, write_fuzz_dataset

        from home_mjx.datasets.registry import open_dataset

        root = write_fuzz_dataset(folder)
        path = root / name.format(house=HOUSE_ID, v2=V2_ID, table=TABLE, door=DOOR)
        house_id = HOUSE_ID if house == "v1" else V2_ID
        return [path.read_bytes()], file_reader(path, lambda: load_and_decode(open_dataset(root), house_id, False))

    return prepare


def metadata_file(name: str) -> Callable[[Path], tuple[list[bytes], Read]]:
    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from fuzz_corpus import write_fuzz_dataset

        from home_mjx.datasets.suncg.read.metadata import read_metadata

        metadata = write_fuzz_dataset(folder) / "metadata"
        return [(metadata / name).read_bytes()], file_reader(metadata / name, lambda: read_metadata(metadata))

    return prepare


def obj(folder: Path) -> tuple[list[bytes], Read]:
    from fuzz_corpus import DOOR, HOUSE_ID, TABLE, write_fuzz_dataset

    from home_mjx.datasets.suncg.formats.obj import read_obj
    from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup

    root = write_fuzz_dataset(folder)
    for name in (f"object/{DOOR}/{DOOR}.mtl", f"room/{HOUSE_ID}/fr_0rm_0w.mtl"):
        (root / "object" / TABLE / Path(name).name).write_bytes((root / name).read_bytes())
    names = f"object/{TABLE}/{TABLE}.obj", f"object/{DOOR}/{DOOR}_0.obj", f"room/{HOUSE_ID}/fr_0rm_0w.obj"
    path = root / "object" / TABLE / "a.obj"
    corners = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl material_0\nf 1/1/1 2/1/2 3//1\n"
    normals = b"vn 0 0 1\nvn 0 1 0\nmtllib 9001.mtl\n" + corners
    good = [(root / name).read_bytes() for name in names]
    return [*good, normals], file_reader(path, lambda: read_obj(path, TextureLookup(root)))


def mtl(folder: Path) -> tuple[list[bytes], Read]:
    from fuzz_corpus import TABLE, write_fuzz_dataset

    from home_mjx.datasets.suncg.formats.mtl import read_mtl
    from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup

    root = write_fuzz_dataset(folder)
    path = root / "object" / TABLE / f"{TABLE}.mtl"
    return [path.read_bytes()], file_reader(path, lambda: read_mtl(path, TextureLookup(root)))


def texture(form: str) -> Callable[[Path], tuple[list[bytes], Read]]:
    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from PIL import Image

        from home_mjx.core.images import open_texture

        rng, good = np.random.default_rng(0), []
        for mode, channels in (("RGB", 3), ("L", 0), ("RGBA", 4), ("P", 0)):
            if form == "jpeg" and mode in ("RGBA", "P"):
                continue
            pixels = rng.integers(0, 256, (12, 16, channels) if channels else (12, 16), dtype=np.uint8)
            image = Image.fromarray(pixels, None if mode == "P" else mode)
            out = io.BytesIO()
            (image.convert("P") if mode == "P" else image).save(out, form)
            good.append(out.getvalue())
        path = folder / "texture.png"
        return good, file_reader(path, lambda: open_texture(path))

    return prepare


# What the package writes itself: the cache


def compiled(kind: str) -> Callable[[Path], tuple[list[bytes], Read]]:
    """An entry of a house or of one of its models; one that is believed is packed, and rays are cast at it."""

    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from fuzz_corpus import HOUSE_ID
        from tiny_dataset import write_tiny_dataset

        from home_mjx.datasets.registry import open_dataset
        from home_mjx.houses.house_cache import HouseCache

        os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
        dataset = open_dataset(write_tiny_dataset(folder / "data"))
        HouseCache(dataset).load(HOUSE_ID)

        def remade(*_: object) -> None:
            raise Remade

        HouseCache._compile = remade
        paths = sorted((folder / "cache").glob(f"*/{kind}/*.zip"))
        kept = {path: path.read_bytes() for path in paths}
        path = max(paths, key=lambda path: path.stat().st_size) if kind == "models" else paths[0]

        def read(data: bytes) -> object:
            path.write_bytes(data)
            return walked(HouseCache(dataset).load(HOUSE_ID))

        return [kept[path]], read

    return prepare


def walked(house: Any) -> int:
    """Goes down all trees of a house as rays do, and looks up what its triangles and instances name; nodes visited."""
    visited = 0
    trees = [(house.top_bvh, len(house.instances.model))]
    trees += [(model.tree, len(model.triangle)) for model in house.models.values()]
    for tree, count in trees:
        left, seen = [(0, 0)], 0
        while left:
            node, depth = left.pop()
            seen += 1
            assert depth < 32
            assert seen <= len(tree.child)
            for code in tree.child[node].tolist():
                if code >= 0:
                    left.append((code, depth + 1))
                else:
                    assert (~code >> 4) + (~code & 15) <= count
        visited += seen
    for key, material in zip(house.instances.model, house.instances.material.tolist(), strict=True):
        house.materials.texture[material + int(house.models[key].slot.max(initial=0))]
    assert np.isfinite(house.instances.pose).all()
    return visited


def kept_text(
    text: bytes, read: Callable[[Path], object], name: str = "file"
) -> Callable[[Path], tuple[list[bytes], Read]]:
    """A file of a given good content."""

    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        return [text], file_reader(folder / name, lambda: read(folder / name))

    return prepare


def kernel(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.core.native import nvrtc

    ptx = "ptx\n" * 50
    return [f"{nvrtc.DIGEST_HEADER}{nvrtc._digest(ptx)}\n{ptx}".encode()], file_reader(
        folder / "a.ptx", lambda: nvrtc._read(folder / "a.ptx")
    )


def sums(path: Path) -> object:
    from home_mjx.core.native import numba_cache as kept

    return kept._noted(path)


def digest_index(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.datasets.suncg import digest_index

    facts = {f"a/{i}": ((i, 2, 3, 4), digest_index.FileFacts(bytes(32), ("x",))) for i in range(4)}
    path = folder / "index"

    def read(data: bytes) -> object:
        _, _, text = data.partition(b"\n")
        import zlib

        path.write_bytes(b"%08x\n" % zlib.crc32(text) + text if len(data) % 2 else data)
        return digest_index._read(path)

    return [digest_index._encode(facts)], read


def whole_house(folder: Path) -> tuple[list[bytes], Read]:
    from fuzz_corpus import HOUSE_ID
    from tiny_dataset import write_tiny_dataset

    from home_mjx.datasets.registry import open_dataset
    from home_mjx.datasets.suncg.write.house import DIGESTS, is_house_complete, write_house

    house = open_dataset(write_tiny_dataset(folder / "tiny")).load_house(HOUSE_ID)
    write_house(folder / "own", house)
    path = folder / "own" / "house" / HOUSE_ID / DIGESTS
    return [path.read_bytes()], file_reader(path, lambda: is_house_complete(folder / "own", HOUSE_ID))


def marker(path: Path) -> object:
    from home_procgen.dataset_writer import claim_root
    from home_procgen.presets import HOME_VARIANT

    return claim_root(path.parent, HOME_VARIANT)


# Training


def checkpoint(alone: bool) -> Callable[[Path], tuple[list[bytes], Read]]:
    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from writers import run_config, state_after

        from home_mjx.training import checkpoint

        path, state, config = folder / "a.npz", state_after(2), run_config()
        if alone:
            checkpoint.save_net(path, state.net, config)
        else:
            checkpoint.save_checkpoint(path, state, config)

        def read() -> object:
            checkpoint.read_config(path)
            return checkpoint.load_net(path, state.net) if alone else checkpoint.load_checkpoint(path, state, config)

        return [path.read_bytes()], file_reader(path, read)

    return prepare


def options(folder: Path) -> tuple[list[bytes], Read]:
    from writers import run_config

    from home_mjx.core.jsonable import from_json, to_json

    path = folder / "a.json"
    return [to_json(run_config()).encode()], lambda data: from_json(data.decode("utf-8", "replace"), path)


def metrics(path: Path) -> object:
    from home_mjx.training.metrics_log import read_lines

    return read_lines(path)


def report(path: Path) -> object:
    from home_mjx.houses.report import find_done_houses, load_report

    return find_done_houses(load_report(path))


METRICS = b"".join(b'{"steps": %d, "loss/value": 0.5, "success": 0.25}\n' % i for i in range(1, 5))
REPORT = b"".join(
    json.dumps(
        {"id": f"{i:032x}", "status": "compiled", "seconds": 1.0, "error": None, "entry": "v/houses/a.zip"}
    ).encode()
    + b"\n"
    for i in range(3)
)


def states(folder: Path) -> tuple[list[bytes], Read]:
    from home_mjx.tasks.env import state_io

    path = folder / "states.npz"
    arrays = {".qpos": np.zeros((3, 5), np.float32), ".step": np.arange(3, dtype=np.int32)}
    state_io._write(path, arrays)
    return [path.read_bytes()], file_reader(path, lambda: state_io._read(path, list(arrays)))


# Recordings


def recording(name: str) -> Callable[[Path], tuple[list[bytes], Read]]:
    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from writers import record

        from home_mjx.training.trajectories import Trajectories

        record(folder)
        path = folder / "data" / name
        return [path.read_bytes()], file_reader(path, lambda: [e.rewards.sum() for e in Trajectories(folder)])

    return prepare


# Tasks and episodes, of a bank


def task_lines(folder: Path) -> tuple[list[bytes], Read]:
    """Lines as far as no house is needed."""
    from home_mjx.core.files import read_json_lines
    from home_mjx.tasks.suite import task_io

    path = folder / "tasks.jsonl"
    known = {"h": 0}
    return [RICH_LINE], file_reader(
        path, lambda: list(read_json_lines(path, "task", lambda line: task_io._parse_row(line, known, {})))
    )


NEED = {"feature": "distance", "first": 0, "maximum": 1.0}
WAY = {"next": "success", "require": [NEED, {"feature": "stopped", "minimum": 1}], "reward": 2.5}
RICH_LINE = b"".join(
    json.dumps(
        {"house": "h", "task": "t", "start": [0.5, 1.0, 0.0], "yaw": 0.5, "length": 3.0, "instruction": "find the bed"}
        | {
            "selectors": [
                {"kind": "object", "coarse": "bed", "object_id": 3},
                {"kind": "place", "place": [1.0, 2.0, 0.0]},
            ]
        }
        | {"stages": [{"transitions": [WAY, {"next": 0, "forbid": [NEED]}], "guide": 0}, {"transitions": [WAY]}]}
        | {
            "sounds": [{"emitter": 0, "clip": "bell", "period": 2.0, "duration": 1.0}],
            "answer": "yes",
            "instructed_agents": [0],
        }
        | {"oracle": [["yes", "no"]], "num_identifying_questions": 0}
    ).encode()
    + b"\n"
    for _ in range(2)
)


def with_bank(which: str) -> Callable[[Path], tuple[list[bytes], Read]]:
    """Files of episodes and of tasks, of two generated houses."""

    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from generated import generate_flats

        from home_mjx import tasks
        from home_mjx.houses import load_bank
        from home_mjx.physics import PhysicsConfig
        from home_mjx.tasks.rules.house_view import house_views
        from home_mjx.tasks.suite import RoomNav, task_io

        os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
        bank, path = (
            load_bank(folder / "houses", ids=generate_flats(folder / "houses", range(2))),
            folder / "a.jsonl",
        )
        if which == "episodes":
            tasks.save_episodes(path, bank, tasks.sample_episodes(bank, 3))
            return [path.read_bytes()], file_reader(path, lambda: tasks.load_episodes(path, bank))
        config = tasks.EnvConfig(sensors=("state",), actions="discrete", physics=PhysicsConfig(impl="kinematic"))
        env = tasks.HouseholdEnv(config, RoomNav(num_tasks=2)).bind(bank)
        tasks.save_tasks(path, bank, env.params.tasks)
        views = house_views(bank)
        task_io.house_views = lambda _: views  # what a house is like does not change
        return [b"\n".join(path.read_bytes().splitlines()[:3])], file_reader(path, lambda: tasks.load_tasks(path, bank))

    return prepare


def of_seed(rng: random.Random, data: bytes) -> bytes:
    """Another seed."""
    return str(rng.randrange(1 << 40)).encode()


def odd_house(folder: Path) -> tuple[list[bytes], Read]:
    """Random odd houses; one that is refused by a typed error is refused, one that differs from its measures fails."""
    from odd_houses import check_odd_house

    return [b"0"], lambda data: check_odd_house(int(data), folder)


JSON, TEXT = (of_json, of_json, of_bytes), (of_text, of_text, of_bytes)
LINES, ARCHIVE = (of_json_lines,), (of_archive, of_archive, of_bytes)
TARGETS = {
    "house": Target(dataset_file("house/{house}/house.json"), JSON),
    "house-v2": Target(dataset_file("house/{v2}/house.json", "v2"), JSON),
    "architecture": Target(dataset_file("wall/{v2}/{v2}.arch.json", "v2"), JSON),
    "lights": Target(metadata_file("suncgModelLights.json"), JSON),
    "models": Target(metadata_file("models.csv"), TEXT),
    "categories": Target(metadata_file("ModelCategoryMapping.csv"), TEXT),
    "obj": Target(obj, TEXT),
    "mtl": Target(mtl, TEXT),
    "png": Target(texture("png"), (of_png, of_png, of_bytes)),
    "jpeg": Target(texture("jpeg"), (of_bytes,)),
    "house-entry": Target(compiled("houses"), ARCHIVE, (Remade,)),
    "model-entry": Target(compiled("models"), ARCHIVE, (Remade,)),
    "kernel": Target(kernel, (of_text, of_bytes), ()),
    "sums": Target(kept_text(b'{"a.nbi": "00", "a.nbc": "11"}', sums), JSON, ()),
    "digests": Target(digest_index, (of_bytes,), ()),
    "whole-house": Target(whole_house, JSON, ()),
    "habitat-dataset": Target(habitat_file("flat.scene_dataset_config.json"), JSON, quick=False),
    "habitat-scene": Target(habitat_file("scenes/flat_0.scene_instance.json"), JSON),
    "habitat-object": Target(habitat_file("configs/chair_1.object_config.json"), JSON),
    "habitat-semantics": Target(habitat_file("flat.semantic_config.json"), JSON),
    "habitat-lights": Target(habitat_file("configs/day.lighting_config.json"), JSON, quick=False),
    "habitat-asset": Target(habitat_file("objects/chair_1.glb"), (of_bytes,)),
    "urdf": Target(urdf, TEXT),
    "matterport": Target(house_file, TEXT),
    "labelled-ply": Target(labelled_ply, (of_bytes,)),
    "hm3d": Target(colors_file, TEXT),
    "front": Target(front, JSON),
    "gltf-scene": Target(scene_file("gltf", "flat.glb", glb), (of_bytes,), quick=False),
    "gltf-parts": Target(parts, JSON, quick=False),
    "usd-scene": Target(usd, TEXT, quick=False),
    "ply": Target(plain("a.ply", PLY.encode()), TEXT),
    "binary-ply": Target(plain("a.ply", binary_ply("little"), binary_ply("big")), (of_bytes,)),
    "stl": Target(plain("a.stl", STL.encode(), binary_stl()), TEXT),
    "dae": Target(plain("a.dae", DAE.encode(), package="collada"), TEXT, quick=False),
    "mjcf-scene": Target(scene_file("mjcf", "flat.xml", mjcf), TEXT, quick=False),
    "procthor-house": Target(scene_file("procthor", "house.json", procthor), JSON, quick=False),
    "habitat-episodes": Target(habitat_episodes, JSON),
    "habitat-rearrangement": Target(rearrangement, JSON),
    "marker": Target(kept_text(b'{"generator": "home_mjx", "version": 5}', marker, "generated.json"), JSON),
    "checkpoint": Target(checkpoint(alone=False), ARCHIVE),
    "agent": Target(checkpoint(alone=True), ARCHIVE),
    "options": Target(options, (of_json,)),
    "metrics": Target(kept_text(METRICS, metrics), LINES),
    "report": Target(kept_text(REPORT, report), LINES),
    "states": Target(states, ARCHIVE),
    "recording": Target(recording("0/part-0.arrow"), (of_bytes,)),
    "notes": Target(recording("metadata.json"), JSON),
    "task-lines": Target(task_lines, LINES),
    "episodes": Target(with_bank("episodes"), LINES, quick=False),
    "tasks": Target(with_bank("tasks"), LINES, quick=False),
    "odd-houses": Target(odd_house, (of_seed,), quick=False),
}
logging.disable(logging.WARNING)
