"""Writers that are killed at their writes: nothing is lost, nothing half-believed. `make crash` kills thousands."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

CRASH = Path(__file__).with_name("crash.py")


def crash(*arguments: str, program: str = "") -> tuple[int, list[dict], str]:
    """What `crash.py` returns and prints; in a process without JAX's threads, since it forks."""
    start = [str(CRASH)] if not program else ["-c", f"import sys; sys.path.insert(0, {str(CRASH.parent)!r})\n{program}"]
    environment = {**os.environ, "PYTHONPATH": str(CRASH.parents[2])}
    done = subprocess.run(
        [sys.executable, *start, *arguments], capture_output=True, text=True, timeout=300, env=environment, check=False
    )
    return done.returncode, [json.loads(line) for line in done.stdout.splitlines()], done.stderr


def test_compiled_houses_and_training_runs_survive_kills_at_their_writes():
    status, lines, said = crash("--writers", "compiled", "training", "--kills", "3")
    assert status == 0, said
    assert [(line["writer"], line["kills"], line["failures"]) for line in lines] == [
        ("compiled", 3, 0),
        ("training", 3, 0),
        ("all", 6, 0),
    ]
    assert all(line["points"] > 100 for line in lines[:-1])


@pytest.mark.slow
def test_every_writer_survives_kills_at_its_writes():
    status, lines, said = crash("--kills", "30")
    assert status == 0, said
    assert lines[-1]["kills"] > 250


CARELESS = """
import crash
from writers import Writer

def straight(folder):
    (folder / "a").write_text("new" * 40)

def renamed(folder):
    (folder / "b").write_text("new" * 40)
    (folder / "b").replace(folder / "a")
    (folder / "c").mkdir(exist_ok=True)

def appended(folder):
    with (folder / "a").open("a") as file:
        file.write("new" * 40)

def before(folder):
    (folder / "a").write_text("old")

def read(folder):
    return (folder / "a").read_text()

def look(folder):
    assert read(folder) in ("old", "new" * 40)

writers = (straight, renamed, appended)
crash.WRITERS |= {writer.__name__: Writer(writer, read, look, before) for writer in writers}
sys.exit(crash.main(["--writers", *(writer.__name__ for writer in writers)]))
"""


def test_careless_writers_are_caught():
    """What is there before it is whole, at three points; what is there before it is on the disk; half of a line."""
    status, lines, said = crash(program=CARELESS)
    assert status == 1
    assert {line["writer"]: line["failures"] for line in lines} == {
        "straight": 3,
        "renamed": 1,
        "appended": 1,
        "all": 5,
    }
    assert "'how': 'torn', 'operation': 'write'" in said
    assert "'how': 'power', 'operation': 'mkdir'" in said
