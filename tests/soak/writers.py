"""What the package writes, as tests of kills do it: what is there before, the writing, and what comes of it."""

import functools
import hashlib
import importlib
import json
import os
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

MODELS = 8  # of a flat: all are written alike
ROWS = [{"house": f"{i:032x}", "start": [0.5 * i, 1.0, 0.0], "yaw": 0.1 * i} for i in range(200)]


@dataclass(frozen=True)
class Writer:
    """Something that writes.

    Attributes:
        write: Writes below a folder; is killed, and done again.
        result: What a user then has, as text, the same after any kill; raises `AssertionError` if something is wrong.
        look: What readers meet between kill and second try; raises `AssertionError` if they believe what is not whole.
        before: Fills the folder.
        warm: Makes what is shared by all tries, before processes are forked.
    """

    write: Callable[[Path], None]
    result: Callable[[Path], str]
    look: Callable[[Path], None] = lambda folder: None
    before: Callable[[Path], None] = lambda folder: None
    warm: Callable[[], object] = lambda: None


def digests(folder: Path) -> dict[str, str]:
    """Of all files that are no leftovers: those begin with a dot."""
    names = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}
    seen = {name: path for name, path in names.items() if not re.search(r"(^|/)\.", name)}
    return {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in seen.items()}


def as_text(found: object) -> str:
    return json.dumps(found, sort_keys=True, default=str)


def loaded(*modules: str) -> Callable[[], None]:
    """Imports what would else be imported in every try."""

    def load() -> None:
        for name in modules:
            importlib.import_module(name)

    return load


# Generated houses


@functools.cache
def generator() -> Any:
    """The module, with one flat that is built once and has objects of few models."""
    from home_procgen import generate
    from home_procgen.presets import Variant

    flat = generate.build_home(0, Variant("flat"))
    (level,) = flat.levels
    few = list(dict.fromkeys(node.model_id for node in level.objects))[:MODELS]
    kept = tuple(node for node in level.objects if node.model_id in few)
    indices = {node.index for node in kept}
    rooms = tuple(replace(room, members=tuple(filter(indices.__contains__, room.members))) for room in level.rooms)
    flat = replace(flat, levels=(replace(level, objects=kept, rooms=rooms),))
    generate.build_home = lambda seed, variant: flat
    return generate


def generate(folder: Path) -> None:
    """Every try begins with an index of intact files that is empty, as is the cache."""
    os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
    generator().generate_dataset(folder / "houses", [0], preset="flat")


def generate_again(folder: Path) -> None:
    """Over a dataset that something has damaged."""
    generate(folder)


def damaged(folder: Path) -> None:
    generate(folder)
    for path in sorted((folder / "houses").rglob("*.*"))[::5]:
        if path.is_file() and path.name != "generated.json":
            path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


@functools.cache
def whole_dataset() -> dict[str, str]:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        generate(Path(folder))
        return digests(Path(folder, "houses"))


def look_at_generated(folder: Path) -> None:
    """A house that is taken for whole is whole."""
    from home_mjx.datasets.suncg.write.house import is_house_complete

    right, found = whole_dataset(), digests(folder / "houses")
    for path in (folder / "houses" / "house").glob("*"):
        if is_house_complete(folder / "houses", path.name):
            own = {name for name in right if path.name in name}
            assert {found[name] for name in own} == {right[name] for name in own}


def generated_result(folder: Path) -> str:
    found = digests(folder / "houses")
    assert found == whole_dataset()
    return as_text(found)


# The cache of compiled houses


@functools.cache
def tiny_houses() -> Path:
    """Two houses; beside the folders of all tries."""
    import atexit
    import shutil
    import tempfile

    from tiny_dataset import HOUSE_ID, edit_house, write_tiny_dataset

    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    root, other = write_tiny_dataset(Path(folder)), HOUSE_ID[:-1] + "2"
    for kind in ("house", "room"):
        shutil.copytree(root / kind / HOUSE_ID, root / kind / other)
    edit_house(root, lambda house: house.update(id=other), other)
    return root


def compile_houses(folder: Path) -> None:
    from home_mjx.houses import job, pools

    os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
    summary = job.compile_dataset(tiny_houses(), resume=True, report=folder / "report.jsonl")
    pools._houses.cache_clear()
    assert summary.failed == 0


@functools.cache
def compiled_entries() -> dict[str, str]:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        compile_houses(Path(folder))
        return digests(Path(folder) / "cache")


def look_at_compiled(folder: Path) -> None:
    """An entry that can be read is right."""
    from home_mjx.core.array_store import READ_ERRORS, read_entry

    found = digests(folder / "cache")
    for path in (folder / "cache").rglob("*.zip"):
        name = path.relative_to(folder / "cache").as_posix()
        try:
            read_entry(path)
        except READ_ERRORS:
            continue
        if "/." not in name:
            assert found[name] == compiled_entries()[name]


def compiled_result(folder: Path) -> str:
    from home_mjx.core.array_store import flatten
    from home_mjx.datasets.registry import open_dataset
    from home_mjx.houses.house_cache import HouseCache
    from home_mjx.houses.report import find_done_houses, read_report

    dataset = open_dataset(tiny_houses())
    os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
    assert find_done_houses(read_report(folder / "report.jsonl")) == set(dataset.house_ids)
    houses, found = HouseCache(dataset), []
    for house_id in dataset.house_ids:
        house = houses.load(house_id)
        arrays, notes = flatten(house, frozenset(("models",)))
        found.append([notes, {name: hashlib.sha256(x.tobytes()).hexdigest() for name, x in arrays.items()}])
    entries = {name: digest for name, digest in digests(folder / "cache").items() if name.endswith(".zip")}
    whole = {name: digest for name, digest in compiled_entries().items() if name.endswith(".zip")}
    # A model whose entry was lost with the power is made again by the next one who reads it. Results of models are not:
    # nobody needs those of a house that is there.
    assert entries.items() <= whole.items()
    assert all("/results/" in f"/{name}" for name in whole.keys() - entries.keys())
    return as_text(found)


# Machine code and kernels

CODE = """
from numba import cfunc, types
from home_mjx.core.native.numba_cache import verify_cache

@verify_cache
def build():
    @cfunc(types.intp(types.intp), cache=True)
    def double(x):
        return 2 * x
    return double
"""


def write_code(folder: Path) -> None:
    (folder / "code_to_keep.py").write_text(CODE)


def build_code(folder: Path) -> Any:
    sys.path.insert(0, str(folder))
    built = importlib.import_module("code_to_keep").build()
    assert built.ctypes(21) == 42
    return built


def code_result(folder: Path) -> str:
    build_code(folder)
    assert build_code(folder).cache_hits == 1
    return ""


def keep_kernel(folder: Path) -> str:
    from home_mjx.core.native import nvrtc

    os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
    (folder / "kernel.cu").exists() or (folder / "kernel.cu").write_text("kernel")
    nvrtc.find_library = lambda: None
    nvrtc.version, nvrtc._known = lambda library: (12, 9), lambda library, capability: capability
    nvrtc._compile = lambda *of: f"ptx of {of[2]} {of[3]}\n" * 400
    ptx = nvrtc.compile_ptx(folder / "kernel.cu", 90)
    assert ptx == "ptx of kernel.cu compute_90\n" * 400
    return ptx


def kernel_result(folder: Path) -> str:
    from home_mjx.core.native import nvrtc

    made = keep_kernel(folder)
    nvrtc._compile = None  # what is kept is read
    kept = nvrtc.compile_ptx(folder / "kernel.cu", 90)
    assert kept == made
    return kept


def write_kernel(folder: Path) -> None:
    (folder / "kernel.cu").write_text("kernel")


# Lines of JSON: episodes and tasks


def write_lines(folder: Path, rows: list[Any]) -> None:
    from home_mjx.core.files import write_json_lines

    write_json_lines(folder / "episodes.jsonl", rows, "episodes")


def read_lines(folder: Path) -> list[Any]:
    from home_mjx.core.files import read_json_lines

    return list(read_json_lines(folder / "episodes.jsonl", "episode", lambda line: line))


def look_at_lines(folder: Path) -> None:
    assert read_lines(folder) in (ROWS[:50], ROWS)


# A training run: checkpoints, metrics, curves, agent

LAST = 6


def state_after(updates: int) -> Any:
    from kept_states import Tree

    rng = np.random.default_rng(updates)
    net = {"dense": rng.normal(size=(20, 30)).astype(np.float32), "bias": np.float32(updates)}
    return Tree(net, np.int32(updates))


def run_config() -> Any:
    from home_mjx.registry import EnvSpec
    from home_mjx.training.config import CPU_CONFIG, RunConfig

    return RunConfig(
        EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav", {"sensors": ("state",)}, num_houses=2), CPU_CONFIG
    )


def train(folder: Path) -> None:
    """As `training.run.train`, without the learning: lines, checkpoints, curves, at last the agent."""
    from home_mjx.tasks.env.observers import ObserverGroup, RunStart
    from home_mjx.training.checkpoint import AGENT_FILE, CHECKPOINT_FILE, read_updates, save_checkpoint, save_net
    from home_mjx.training.metrics_log import CurvesPlot, MetricsLog, TensorBoardLog

    path, config = folder / CHECKPOINT_FILE, run_config()
    done = read_updates(path) if path.exists() else 0
    log = MetricsLog(folder, done)
    with ObserverGroup((log, TensorBoardLog(folder / "tensorboard", done), CurvesPlot(log))) as records:
        records.on_run_start(RunStart("ppo", None, "steps", LAST, done))
        for number in range(done + 1, LAST + 1):
            records.on_log({"steps": number, "loss/value": 1.0 / number})
            if number % 2 == 0:
                save_checkpoint(path, state_after(number), config)
        records.on_checkpoint(path, LAST)
    save_net(folder / AGENT_FILE, state_after(LAST).net, config)


def begun_training(folder: Path) -> None:
    """Killed after four updates, the last line half written."""
    from home_mjx.training.checkpoint import CHECKPOINT_FILE, save_checkpoint

    save_checkpoint(folder / CHECKPOINT_FILE, state_after(2), run_config())
    lines = [json.dumps({"steps": number, "loss/value": 1.0 / number}) for number in range(1, 5)]
    (folder / "metrics.jsonl").write_text("\n".join(lines)[:-5])


def look_at_training(folder: Path) -> None:
    """The checkpoint is whole, and all lines up to it are there."""
    from home_mjx.training.checkpoint import CHECKPOINT_FILE, load_checkpoint, read_updates
    from home_mjx.training.metrics_log import read_lines

    done = read_updates(folder / CHECKPOINT_FILE)
    found, right = load_checkpoint(folder / CHECKPOINT_FILE, state_after(0), run_config()), state_after(done)
    assert np.array_equal(found.net["dense"], right.net["dense"])
    steps = [line["steps"] for line in read_lines(folder / "metrics.jsonl")]
    assert steps[:done] == list(range(1, done + 1)), (steps, done)


def training_result(folder: Path) -> str:
    from home_mjx.training.checkpoint import load_net
    from home_mjx.training.metrics_log import read_lines

    look_at_training(folder)
    net = load_net(folder / "agent.npz", state_after(0).net)
    assert np.array_equal(net["dense"], state_after(LAST).net["dense"].astype(np.float16).astype(np.float32))
    assert (folder / "curves.png").read_bytes()[-8:-4] == b"IEND"
    return as_text(read_lines(folder / "metrics.jsonl"))


# States


def write_states(folder: Path, seed: int = 1) -> None:
    from home_mjx.tasks.env import state_io

    state_io._write(folder / "states.npz", {".qpos": np.random.default_rng(seed).normal(size=(30, 40))})


def read_states(folder: Path) -> np.ndarray:
    from home_mjx.tasks.env import state_io

    return state_io._read(folder / "states.npz", [".qpos"])[0]


def states_result(folder: Path) -> str:
    look_at_states(folder)
    return hashlib.sha256(read_states(folder).tobytes()).hexdigest()


def look_at_states(folder: Path) -> None:
    seeds = [
        seed
        for seed in (0, 1)
        if np.array_equal(read_states(folder), np.random.default_rng(seed).normal(size=(30, 40)))
    ]
    assert len(seeds) == 1


# Recordings

EPISODES = 5


def recorded(number: int) -> dict[str, Any]:
    rng, length = np.random.default_rng(number), number % 3 + 1
    seen = {"state": rng.normal(size=(length + 1, 4)).astype(np.float32)}
    ends = np.arange(length) == length - 1
    actions = rng.integers(0, 6, length).astype(np.int32)
    rewards = rng.normal(size=length).astype(np.float32)
    return {"observations": seen, "actions": actions, "rewards": rewards, "terminations": ends, "truncations": ~ends}


def record(folder: Path) -> None:
    from home_mjx.training.trajectories import writer

    box = {"type": "Box", "dtype": "float32", "shape": [4], "low": [0] * 4, "high": [1] * 4}
    spaces = {"type": "Dict", "subspaces": {"state": box}}, {"type": "Discrete", "dtype": "int64", "start": 0, "n": 6}
    texts = {name: json.dumps(space) for name, space in zip(("observation_space", "action_space"), spaces, strict=True)}
    writer._make_metadata = lambda env, agent, without: {"dataset_id": "home_mjx/test-v0", **texts}
    writer.EPISODES_PER_METADATA_UPDATE = 2
    with writer.TrajectoryWriter(folder, None, "expert", resume=True) as out:
        for number in range(out.episodes, EPISODES):
            out.add(recorded(number), {"instruction": f"task {number}"})


def begun_recording(folder: Path) -> None:
    global EPISODES
    whole, EPISODES = EPISODES, 2
    record(folder)
    EPISODES = whole


def look_at_recording(folder: Path) -> None:
    """The episodes that the metadata count are there, and are right."""
    from home_mjx.training.trajectories import Trajectories

    data = Trajectories(folder)
    assert len(data) >= 2
    for number, episode in enumerate(data):
        right = recorded(number)
        assert np.array_equal(episode.observations["state"], right["observations"]["state"])
        assert np.array_equal(episode.rewards, right["rewards"])


def recording_result(folder: Path) -> str:
    from home_mjx.training.trajectories import Trajectories

    look_at_recording(folder)
    data = Trajectories(folder)
    assert len(data) == EPISODES
    return as_text([data.metadata["total_steps"], [episode.notes for episode in data]])


# Films and pictures


def film(folder: Path, shade: int = 200) -> None:
    from home_mjx.core.files import write_all_or_none, write_json_lines
    from home_mjx.viewer.pictures import media

    frames = np.full((3, 16, 16, 3), shade, np.uint8)
    with write_all_or_none(folder / "play", "film") as beside:
        media.write_wav(beside / "film.wav", np.full((2, 800), shade / 255), 8000)
        media.write_mp4(beside / "film.mp4", frames, 10.0, beside / "film.wav")
        media.write_png(beside / "film.png", frames[0])
        write_json_lines(beside / "film.jsonl", [{"shade": shade}], "outcomes")


def look_at_film(folder: Path) -> None:
    """Each file is that of the old film or of the new one."""
    from PIL import Image

    with Image.open(folder / "play" / "film.png") as image:
        assert image.getpixel((0, 0)) in ((9, 9, 9), (200, 200, 200))
    assert json.loads((folder / "play" / "film.jsonl").read_text())["shade"] in (9, 200)
    assert (folder / "play" / "film.mp4").stat().st_size > 500


def film_result(folder: Path) -> str:
    look_at_film(folder)
    assert json.loads((folder / "play" / "film.jsonl").read_text())["shade"] == 200
    return as_text({name: digest for name, digest in digests(folder).items() if not name.endswith("mp4")})


# A folder that is replaced: an exported MJCF


def export(folder: Path, version: int = 2) -> None:
    from home_mjx.core.files import replace_folder

    replace_folder(folder / "mjcf", {f"assets/{i}.png": bytes([version]) * 500 for i in range(5)} | {"house.xml": b"x"})


def look_at_export(folder: Path) -> None:
    found = {path.read_bytes()[0] for path in (folder / "mjcf").rglob("*.png")}
    assert found in (set(), {1}, {2}), found
    assert len(list((folder / "mjcf").rglob("*.*"))) in (0, 6)


def export_result(folder: Path) -> str:
    look_at_export(folder)
    return as_text(digests(folder))


TRAINING = (
    *(f"home_mjx.{name}" for name in ("training.checkpoint", "training.metrics_log", "tasks.suite.point_nav")),
    *("matplotlib.figure", "matplotlib.ticker", "matplotlib.backends.backend_agg", "tensorboardX.record_writer"),
)
STATES = loaded("home_mjx.tasks.env.state_io")
WRITERS = {
    "compiled": Writer(compile_houses, compiled_result, look_at_compiled, warm=compiled_entries),
    "training": Writer(train, training_result, look_at_training, begun_training, loaded(*TRAINING)),
    "generated": Writer(generate, generated_result, look_at_generated, warm=whole_dataset),
    "mended": Writer(generate_again, generated_result, look_at_generated, damaged, warm=whole_dataset),
    "recording": Writer(
        record, recording_result, look_at_recording, begun_recording, loaded("home_mjx.training.trajectories.writer")
    ),
    "lines": Writer(
        lambda folder: write_lines(folder, ROWS),
        lambda folder: as_text(read_lines(folder)),
        look_at_lines,
        lambda folder: write_lines(folder, ROWS[:50]),
    ),
    "states": Writer(write_states, states_result, look_at_states, lambda folder: write_states(folder, 0), STATES),
    "film": Writer(
        film, film_result, look_at_film, lambda folder: film(folder, 9), loaded("home_mjx.viewer.pictures.media")
    ),
    "export": Writer(export, export_result, look_at_export, lambda folder: export(folder, 1)),
    "kernel": Writer(keep_kernel, kernel_result, before=write_kernel),
    "code": Writer(build_code, code_result, before=write_code, warm=loaded("home_mjx.core.native.numba_cache")),
}
