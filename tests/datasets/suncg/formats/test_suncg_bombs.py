"""Files of tens of megabytes that unpack to gigabytes, each read by a process of its own: bounded time and memory."""

import json
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import pytest
from tiny_arch import arch_path, write_tiny_v2
from tiny_dataset import HOUSE_ID, TABLE, write_tiny_dataset

pytestmark = pytest.mark.slow
SECONDS, MEBIBYTES = 60.0, 1_500  # of processor time; at its largest, the whole process with its libraries

PROGRAM = """
import resource, sys
from home_mjx.errors import HomeMjxError
from home_mjx.datasets import open_dataset
from home_mjx.datasets import validate_house
from home_mjx.core.images import open_texture

def read():
    dataset = open_dataset(sys.argv[1])
    house = dataset.load_house(dataset.house_ids[0])
    for mesh in house.models.values():
        [open_texture(material.texture) for material in mesh.materials if material.texture]
    dataset.metadata

def outcome(action):
    try:
        action()
        return "read"
    except HomeMjxError as error:
        return str(error)

first = outcome(read)
second = outcome(lambda: validate_house(open_dataset(sys.argv[1]), sys.argv[2]))
usage = resource.getrusage(resource.RUSAGE_SELF)
# Not ru_maxrss, which begins with what the parent had when it started this process.
peak = next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM"))
print(usage.ru_utime + usage.ru_stime, peak / 1024, first[:300].replace(chr(10), " "), sep="|")
"""
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def house(root, body):
    document = f'{{"version": "suncg@1.0.0", "id": "{HOUSE_ID}", "levels": [{{"id": "0", "nodes": [{body}]}}]}}'
    (root / "house" / HOUSE_ID / "house.json").write_text(document)


def table(root, text, kind="obj"):
    (root / "object" / TABLE / f"{TABLE}.{kind}").write_text(text)


def png(width, height, data):
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", data), (b"IEND", b"")]
    body = b"".join(struct.pack(">I", len(d)) + n + d + struct.pack(">I", zlib.crc32(n + d)) for n, d in chunks)
    return b"\x89PNG\r\n\x1a\n" + body


def repeated(text, size):
    return text * (size // len(text))


def room_of_members(count):
    return json.dumps(COPY | {"nodeIndices": [-1] * count}, separators=(",", ":"))


def listed(node, count):
    return json.dumps([node] * count)[1:-1]


MB = 1 << 20
COPY = {"type": "Room", "modelId": "fr_0rm_0"}
BOMBS = {  # what is written, and what the error says
    "ten million faces": (lambda root: table(root, SQUARE + "f 1 2 3\n" * 10_000_000), "are read"),
    "a million faces": (lambda root: table(root, SQUARE + "f 1 2 3\n" * 1_000_000), "read"),
    "a face of ten million corners": (lambda root: table(root, SQUARE + "f" + " 1" * 10_000_000), "corners"),
    "four million corners": (lambda root: table(root, SQUARE + "f" + " 1" * 4_000_000), "read"),
    "thirty megabytes of empty lines": (lambda root: table(root, "\n" * 30 * MB), "lines, at most"),
    "a million vertices": (lambda root: table(root, "v 1 2 3\n" * 1_000_000 + "f 1 2 3"), "read"),
    "a million materials": (lambda root: table(root, "".join(f"newmtl {i}\n" for i in range(10**6)), "mtl"), ""),
    "half a million groups": (
        lambda root: table(root, SQUARE + "".join(f"o {i}\nf 1 2 3\n" for i in range(500_000))),
        "read",
    ),
    "a name of thirty megabytes": (
        lambda root: table(root, "newmtl " + "x" * 30 * MB, "mtl"),
        "is not in the material",
    ),
    "a hundred megabytes": (lambda root: table(root, "#" * 100 * MB), "bytes, at most"),
    "lists in lists": (lambda root: house(root, repeated("[],", 15 * MB) + "[]"), "at most"),
    "objects": (lambda root: house(root, repeated("{},", 15 * MB) + "{}"), "at most"),
    "nodes without fields": (lambda root: house(root, "{}," * 9_999 + "{}"), "house has no visible node"),
    "ten thousand copies of a room": (
        lambda root: house(root, listed(COPY, 10_000)),
        "read",
    ),
    "ten thousand tables": (
        lambda root: house(root, listed({"type": "Object", "modelId": TABLE}, 10_000)),
        "read",
    ),
    "five million members": (lambda root: house(root, room_of_members(5_000_000)), "entries"),
    "a hundred thousand members": (lambda root: house(root, room_of_members(100_000)), "read"),
    "a number of fifteen megabytes": (lambda root: house(root, "1" * 15 * MB), "not valid JSON"),
    "a string of fifteen megabytes": (lambda root: house(root, '"' + "x" * 15 * MB + '"'), "expected an object"),
    "brackets": (lambda root: house(root, "[" * 15 * MB), "not valid JSON"),
    "an image of four gigapixels": (
        lambda root: (root / "texture" / "wood_1.png").write_bytes(png(65_535, 65_535, b"")),
        "cannot read texture",
    ),
    "an image of 90 megapixels in 300 kilobytes": (
        lambda root: (root / "texture" / "wood_1.png").write_bytes(png(9_400, 9_500, zlib.compress(bytes(300 * MB)))),
        "cannot read texture",
    ),
    "the largest image that is decoded": (
        lambda root: (root / "texture" / "wood_1.png").write_bytes(
            png(5_792, 5_792, zlib.compress(bytes((5_792 * 3 + 1) * 5_792)))
        ),
        "read",
    ),
    "a table of a million columns": (
        lambda root: (root / "metadata" / "models.csv").write_text("a," * 1_000_000 + "\n" + "1," * 1_000_000),
        "table lacks the column",
    ),
    "a table with a cell of thirty megabytes": (
        lambda root: (root / "metadata" / "models.csv").write_text("id,front,minPoint,maxPoint\n" + "x" * 30 * MB),
        "not valid CSV",
    ),
}
WALL = {"type": "Wall", "id": "w", "roomId": "0_0", "points": [[0, 0, 0], [1, 0, 0]]}
TANGLE = [[i * i % 1009, 0, i % 977] for i in range(100_000)]
ARCH_BOMBS = {
    "ten thousand walls": [WALL] * 10_000,
    "a floor of a hundred thousand corners": [
        {"type": "Floor", "roomId": "0_0", "offset": [0, 0, 0], "points": [TANGLE]}
    ],
    "fifty floors of a thousand corners": [
        {"type": "Floor", "roomId": "0_0", "offset": [0, 0, 0], "points": [TANGLE[:1_000]]}
    ]
    * 50,
}


def read(root: Path) -> tuple[float, float, str]:
    """Processor seconds, largest memory in MiB, and the error or `read`."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", PROGRAM, str(root), HOUSE_ID],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr[-3_000:]
    seconds, memory, outcome = done.stdout.strip().split("|", 2)
    return float(seconds), float(memory), outcome


def check(name, root, message):
    seconds, memory, outcome = read(root)
    print(f"\n{name}: {seconds:.1f} s, {memory:.0f} MiB: {outcome[:120]}")  # noqa: T201
    assert message in outcome
    assert seconds < SECONDS
    assert memory < MEBIBYTES


@pytest.mark.parametrize("name", BOMBS)
def test_large_files(tmp_path, name):
    root = write_tiny_dataset(tmp_path)
    write, message = BOMBS[name]
    write(root)
    check(name, root, message)


@pytest.mark.parametrize("name", ARCH_BOMBS)
def test_large_architecture(tmp_path, name):
    root = write_tiny_v2(tmp_path)
    arch_path(root).write_text(json.dumps({"version": "suncg-arch@1.0.0", "elements": ARCH_BOMBS[name]}))
    check(name, root, "")
