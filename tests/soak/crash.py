"""Kills every writer of the package at its writes, and looks at what is left.

    python tests/soak/crash.py [--writers NAME ...] [--kills N] [--seconds S] [--seed N]

Each try begins anew: a forked child writes and dies at one operation, another one looks at what readers meet, writes
again and looks at the result. One JSON object a line for each writer; the last one has the sums. Exits with 1 if a try
fails; the same arguments repeat it. Without `--kills`: every operation, in each way to die. A writer whose package is
not installed is left out and says so.
"""

import argparse
import json
import logging
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers"), str(Path(__file__).parent)]
os.environ.setdefault("JAX_PLATFORMS", "cpu")
os.environ.setdefault("MPLBACKEND", "agg")

from kill_points import BEFORE, POWER, TORN, Disk, in_child  # noqa: E402
from left_out import missing_package  # noqa: E402
from writers import WRITERS, Writer  # noqa: E402

MEMORY = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None  # where a forced write takes no time


class Point(NamedTuple):
    """Where and how a writer dies."""

    at: int
    how: str
    operation: str


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--writers", nargs="+", default=list(WRITERS), choices=list(WRITERS))
    parser.add_argument("--kills", type=int, help="at most so many of each writer")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="ends after so long")
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args(arguments)
    logging.disable(logging.WARNING)
    warnings.simplefilter("ignore", DeprecationWarning)  # forks of a process with threads, such as of libraries
    end, total = time.monotonic() + args.seconds, {"kills": 0, "failures": 0, "left_out": 0}
    for name in args.writers:
        package = wanted(WRITERS[name])
        record = {"writer": name, "left_out": 1, "package": package}
        if not package:
            record = attack(name, WRITERS[name], args.kills, args.seed, end)
        print(json.dumps(record), flush=True)
        for key in total:
            total[key] += record.get(key, 0)
    print(json.dumps({"writer": "all", **total}), flush=True)
    return int(total["failures"] > 0)


def wanted(writer: Writer) -> str:
    """A package that the writer needs and that is not installed; else nothing."""
    try:
        writer.warm()
    except Exception as error:
        if not missing_package(error):
            raise
        return missing_package(error)
    return ""


def attack(name: str, writer: Writer, kills: int | None, seed: int, end: float) -> dict[str, Any]:
    """Kills a writer at some or all of its points."""
    begun = time.monotonic()
    with tempfile.TemporaryDirectory(dir=MEMORY) as work:
        template, folder = Path(work, "before"), Path(work, "now")
        template.mkdir()
        assert in_child(lambda: writer.before(template)) == 0
        points, right = known(writer, template, folder)
        chosen = points if kills is None else spread(points, kills, seed)
        done, failed = 0, []
        for point in chosen:
            if time.monotonic() > end:
                break
            done += 1
            trouble = survive(writer, point, template, folder, right)
            if trouble:
                failed.append({**point._asdict(), "trouble": trouble})
                print(f"{name}: {failed[-1]}", file=sys.stderr, flush=True)
    seconds = round(time.monotonic() - begun, 1)
    return {"writer": name, "points": len(points), "kills": done, "failures": len(failed), "seconds": seconds}


def known(writer: Writer, template: Path, folder: Path) -> tuple[list[Point], str]:
    """Where the writer can be killed, and what comes of it if it is not."""
    shutil.copytree(template, folder)
    notes = folder.with_name("notes")

    def counted() -> None:
        disk = Disk()
        disk.install()
        writer.write(folder)
        operations = list(disk.operations)
        notes.write_text(json.dumps(operations))

    def looked() -> None:
        notes.with_suffix(".right").write_text(writer.result(folder))

    assert in_child(counted) == 0
    assert in_child(looked) == 0
    shutil.rmtree(folder)
    points = []
    for at, operation in enumerate(json.loads(notes.read_text()), 1):
        ways = (BEFORE, TORN, POWER) if operation == "write" else (BEFORE, POWER)
        points += [Point(at, how, operation) for how in ways]
    return points, notes.with_suffix(".right").read_text()


def spread(points: list[Point], kills: int, seed: int) -> list[Point]:
    """So many of them: one of each stretch of equal length."""
    rng, size = random.Random(seed), len(points) / min(kills, len(points))
    return [points[int((i + rng.random()) * size)] for i in range(min(kills, len(points)))]


def survive(writer: Writer, point: Point, template: Path, folder: Path, right: str) -> str:
    """What is wrong after a kill; nothing is."""
    shutil.copytree(template, folder)
    result = folder.with_name("result")
    result.unlink(missing_ok=True)

    def killed() -> None:
        Disk(point.at, point.how).install()
        writer.write(folder)

    def again() -> None:
        writer.write(folder)
        result.write_text(writer.result(folder))

    try:
        status = in_child(killed)
        if status != -signal.SIGKILL:
            return f"it ended with {status} and was not killed"
        if in_child(lambda: writer.look(folder)):
            return "what was left is believed and wrong, or cannot be read"
        if in_child(again):
            return "the second try fails"
        return "" if result.read_text() == right else f"the second try has another result: {result.read_text():.300}"
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
