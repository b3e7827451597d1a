"""What fuzzing starts from: a tiny dataset, odd values and words, and the harness that watches a dataset being read."""

import functools
import hashlib
import os
import re
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from tiny_arch import arch_document, arch_path
from tiny_dataset import DOOR, HOUSE_ID, TABLE, house_document, write_json, write_tiny_dataset

from home_mjx.core.images import open_texture
from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.validate.validate import validate_house
from home_mjx.errors import HomeMjxError
from home_mjx.scene_compile.pipeline.compile import compile_house

V2_ID = HOUSE_ID[:-1] + "2"  # a second house, with an architecture file instead of meshes of rooms
JSON_FILES = (
    f"house/{HOUSE_ID}/house.json",
    f"house/{V2_ID}/house.json",
    f"wall/{V2_ID}/{V2_ID}.arch.json",
    "metadata/suncgModelLights.json",
)
TEXT_FILES = (
    f"object/{TABLE}/{TABLE}.obj",
    f"object/{DOOR}/{DOOR}_0.obj",
    f"object/{TABLE}/{TABLE}.mtl",
    f"room/{HOUSE_ID}/fr_0rm_0w.obj",
    f"room/{HOUSE_ID}/fr_0gd_1f.mtl",
    "metadata/models.csv",
    "metadata/ModelCategoryMapping.csv",
)
IMAGES = ("texture/wood_1.png", "texture/wallp_0.jpg", "texture/s/123.jpg")
WHOLE_FILE = (  # errors that have no place inside of their file
    "file is missing",
    "file cannot be read",
    "file has ",
    "house has no place",  # to stand: of the whole house
    "the house has no room",
    "mesh has no faces",
    "faces have about",
    "cannot read texture",
    "folder contains no house",
    "not valid JSON",
    "expected an object",
)


def write_fuzz_dataset(root: Path) -> Path:
    """A v1 and a v2 house that share their models."""
    write_tiny_dataset(root)
    write_json(root / "house" / V2_ID / "house.json", house_document(V2_ID) | {"version": "suncg@1.0.2"})
    write_json(arch_path(root, V2_ID), arch_document(V2_ID))
    return root


@dataclass
class Watch:
    """Reads damaged datasets; fails if anything but a typed, located error comes out, and keeps the figures."""

    root: Path
    cases: int = 0
    errors: int = 0
    worst: float = 0.0  # [s] of processor time
    compiles: bool = False  # what can be read
    messages: Counter[str] = field(default_factory=Counter)

    def read(self, name: str = "") -> None:
        """Reads and validates the houses that use a file, or all; reads the tables, decodes the textures."""
        before = fingerprint(self.root)
        self.cases += 1
        start = time.process_time()
        with opened_files() as opened:
            failed = list(self._attempts(name))
        self.worst = max(self.worst, time.process_time() - start)
        self.errors += bool(failed)
        for error in failed:
            self.check(error)
        outside = {path for path in opened if not path.startswith((str(self.root), *allowed())) and path != os.devnull}
        assert not outside, f"read outside of the dataset: {outside}"
        assert fingerprint(self.root) == before, "something was written"

    def _attempts(self, name: str) -> Iterator[HomeMjxError]:
        dataset = open_dataset(self.root)
        actions: list[Callable[[], object]] = [lambda: dataset.metadata]
        for house_id in dataset.house_ids if not name else users_of(name):
            actions.append(lambda house_id=house_id: load_and_decode(dataset, house_id, self.compiles))
            actions.append(lambda house_id=house_id: [str(finding) for finding in validate_house(dataset, house_id)])
        for action in actions:
            try:
                action()
            except HomeMjxError as error:
                yield error

    def check(self, error: HomeMjxError) -> None:
        """Whether an error says where it is and what to do, in a few lines that can be printed."""
        text = str(error)
        text.encode()
        assert len(text) < 3_000, text
        assert error.hint
        assert error.file, text
        assert error.file.startswith(str(self.root)), text
        assert error.element or error.message.startswith(WHOLE_FILE), text
        self.messages[re.sub(r"`[^`]*`?|[-\d.]+", "…", error.message)[:60]] += 1

    def report(self) -> str:
        """The figures in one line."""
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        kinds = len(self.messages)
        return (
            f"{self.cases} cases, {self.errors} refused with typed errors of {kinds} kinds, "
            f"worst {self.worst:.2f} s, peak {peak:.0f} MiB"
        )


def users_of(name: str) -> tuple[str, ...]:
    """A house that uses a file; the one without meshes of rooms only if the other does not."""
    return () if name.startswith("metadata") else (V2_ID,) if V2_ID in name else (HOUSE_ID,)


@functools.cache
def compile_the_compiler() -> None:
    """Lets Numba translate what houses are compiled by, which in a fresh checkout takes longer than any case may."""
    with tempfile.TemporaryDirectory() as folder:
        dataset = open_dataset(write_tiny_dataset(Path(folder)))
        compile_house(dataset.load_house(HOUSE_ID), dataset.metadata)


def load_and_decode(dataset, house_id: str, compiles: bool) -> None:
    """One house, with its textures decoded, and compiled if that is wanted."""
    house = dataset.load_house(house_id, ReadOptions(plants=False))
    meshes = list(house.models.values())
    owners = [mesh.materials for mesh in meshes]
    owners += [node.materials for level in house.levels for node in (*level.objects, *level.boxes)]
    for path in {material.texture for materials in owners for material in materials if material.texture}:
        open_texture(path)
    if compiles:
        compile_house(house, dataset.metadata)


def fingerprint(root: Path) -> str:
    """Names, contents and times of all files."""
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*")):
        status = path.lstat()
        digest.update(f"{path}{status.st_mode}{status.st_size}{status.st_mtime_ns}".encode())
    return digest.hexdigest()


_opened: list[str] | None = None


def _audit(event: str, arguments: tuple) -> None:
    if _opened is not None and event in ("open", "os.listdir", "os.scandir") and arguments:
        path = arguments[0]
        if isinstance(path, str | bytes | os.PathLike):
            _opened.append(os.path.abspath(os.fsdecode(path)))


@contextmanager
def opened_files() -> Iterator[list[str]]:
    """The files and folders that Python opens meanwhile."""
    global _opened
    if not getattr(sys, "_home_mjx_audits", False):  # hooks cannot be removed
        sys.addaudithook(_audit)
        sys._home_mjx_audits = True  # type: ignore[attr-defined]
    _opened = found = []
    try:
        yield found
    finally:
        _opened = None


def allowed() -> tuple[str, ...]:
    """Where Python itself reads, when a module is imported late."""
    return (
        sys.prefix,
        sys.base_prefix,
        str(Path(os.__file__).parent),
        *filter(None, sys.path),
        str(Path(__file__).parents[2]),
    )


PLAIN_VALUES: list = [
    None, True, False, 0, -1, 1, 2, 7, 1e308, -1e308, 1e-320, 10**30, 2**63, float("nan"), float("inf"),
    float("-inf"), "", "0", "1", ".", "..", "/", "_0", "._0", ".._0", "a" * 300, "é" * 120, "a\0b", "\ud800",
    "../../etc/passwd", "..\\..\\etc\\passwd", "/etc/passwd", "~/x", "C:\\x", "file:///etc/passwd", "#ff00zz",
    "#ffffff", "Room", "Object", "Box", "Ground", TABLE, f"{DOOR}_0", f"{DOOR}_2", "wood_1", "123", "a.png",
    [], {}, [[]], [None], [0] * 16, [float("nan")] * 16, [1e6] * 16, [1e-300] * 16, [0.0] * 3, [-1e6] * 3,
    [1e-9, 1, 1], list(range(-50, 50)), [2] * 50, {"min": [0, 0, 0], "max": [0, 0, 0]}, {"a": {"b": {}}},
]  # fmt: skip
PLAIN_WORDS = [
    "", "nan", "inf", "-inf", "1e999", "-0", "1_0", "1e-320", "99999999999999999999", "-99999", "0", "1/2/3/4",
    "/", "//", "1//", "-1/-1", "1/1/1", "#", "\\", "\t", "\r", "\x00", "\u2028", "\x85", "\x1c", "١", "0x10",
    "f", "v", "vt", "usemtl", "mtllib", "newmtl", "o", "../../../../etc/passwd", "/etc/passwd", f"{TABLE}.obj",
    "../../house", "..", ".", "a" * 5_000, '"', ",", ",,", "material_0", "material_1", "map_Kd", "Kd",
    "-clamp on", f"../{TABLE}/{TABLE}.mtl", f"./{TABLE}.mtl", "map_Kd ../../texture//wood_1.png",
]  # fmt: skip


def places(document: object, path: tuple = ()) -> list[tuple]:
    """The paths of all values in a JSON document."""
    inner = (
        document.items() if isinstance(document, dict) else enumerate(document) if isinstance(document, list) else ()
    )
    return [path, *(place for key, value in inner for place in places(value, (*path, key)))]


def at(document: object, path: tuple) -> object:
    for key in path:
        document = document[key]
    return document
