"""Changed files of every kind, some of each: `make fuzz` reads them by the million. What has failed once is kept."""

import json
import os
import subprocess
import sys
from pathlib import Path

FUZZ = Path(__file__).with_name("fuzz.py")


def fuzz(*arguments: object, program: str = "") -> tuple[int, dict[str, dict], str]:
    """What `fuzz.py` returns and prints, by target; in a process without JAX's threads, since it forks."""
    start = [str(FUZZ)] if not program else ["-c", f"import sys; sys.path.insert(0, {str(FUZZ.parent)!r})\n{program}"]
    environment = {**os.environ, "PYTHONPATH": str(FUZZ.parents[2])}
    done = subprocess.run(
        [sys.executable, *start, *map(str, arguments)],
        capture_output=True, text=True, timeout=300, env=environment, check=False,
    )  # fmt: skip
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return done.returncode, {line["target"]: line for line in lines}, done.stderr


def test_changed_files_are_read_or_refused(tmp_path):
    status, found, said = fuzz("--quick", "--cases", 10, "--out", tmp_path)
    assert status == 0, said
    assert found.pop("all")["cases"] == 10 * len(found) > 225
    assert all(line["cases"] == 10 for line in found.values())
    assert sum(line["refused"] for line in found.values()) > 0.3 * 10 * len(found)
    assert sum(line["read"] for line in found.values()) > 0.1 * 10 * len(found)


def test_odd_houses_are_what_trimesh_and_c_mujoco_make_of_them(tmp_path):
    """`make fuzz ARGS="--targets odd-houses --cases 10000 --seconds 1e9"` has ten thousand."""
    status, found, said = fuzz("--targets", "odd-houses", "--cases", 4, "--out", tmp_path)
    assert (status, found.get("odd-houses", {}).get("cases")) == (0, 4), said


CARELESS = """
import os, signal, time
import fuzz
from mutations import of_bytes
from readers import TARGETS, Target

def reads(data):
    if data[:1] == b"d":
        return None
    kind = data[0] % 4 if data else 0
    if kind == 0:
        raise KeyError("not typed")
    if kind == 1:
        os.kill(os.getpid(), signal.SIGSEGV)
    if kind == 2:
        len(b"x" * (65 << 20))
    if kind == 3:
        time.sleep(60)

fuzz.SLOW, fuzz.MOST = 1.0, 50 << 10
TARGETS["careless"] = Target(lambda folder: ([b"d" * 16], reads), (of_bytes,))

def makes(rng, data):
    return b"d" * len(b"x" * (65 << 20)) if rng.random() < 0.2 else data

def makes_none(rng, data):
    return data

clock, late = signal.setitimer, []

def stops_late(which, seconds, interval=0.0):
    # The bell rings once while the clock is stopped, between a reader's end and the next line.
    clock(which, seconds, interval)
    if seconds == 0 and late:
        late.clear()
        raise fuzz.Slow

signal.setitimer = stops_late
TARGETS["late"] = Target(lambda folder: ([b"d" * 16], lambda data: late.append(data)), (makes_none,))
TARGETS["long"] = Target(lambda folder: ([b"d" * 16], reads), (makes,))
sys.exit(fuzz.main())
"""


def test_careless_readers_are_caught(tmp_path):
    """An error without a type, a signal, too much memory, too much time: each is found, and its input is kept."""
    status, found, said = fuzz("--targets", "careless", "--cases", 80, "--out", tmp_path, program=CARELESS)
    assert (status, found.get("careless", {}).get("cases")) == (1, 80), said
    kept = [path for path in tmp_path.iterdir() if path.suffix != ".txt"]
    assert len(kept) == found["careless"]["failed"] > 4
    assert all(not path.read_bytes().startswith(b"d") for path in kept)
    for trouble in ("KeyError: 'not typed'", f"ended by {11}", "takes 6", "slow"):
        assert trouble in said


def test_what_it_takes_to_make_an_input_is_not_held_against_its_reader(tmp_path):
    status, found, said = fuzz("--targets", "long", "--cases", 20, "--out", tmp_path, program=CARELESS)
    assert (status, found["long"]["failed"], found["long"]["read"]) == (0, 0, 20), said


def test_a_bell_that_rings_as_the_reader_ends_is_no_error_of_the_hunt(tmp_path):
    status, found, said = fuzz("--targets", "late", "--cases", 4, "--out", tmp_path, program=CARELESS)
    assert (status, found.get("late", {}).get("failed")) == (1, 4), said
    assert "slow" in said
