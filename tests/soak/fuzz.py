"""Reads changed files by all readers of the package, for as long as is wanted.

    python tests/soak/fuzz.py [--targets NAME ...] [--seconds S] [--total N] [--seed N] [--quick] [--out FOLDER]

Every input is read or refused by a typed error, within 10 s and 1 GiB, and no input ends the process. Inputs that break
this are written to a folder, by target and case; the same seed and case make the same input. Inputs that have failed
once (`tests/soak/kept`) are read first. Time and number are dealt out evenly: each target gets the same share of
`--seconds`, which runs while it reads and not while it gets ready, and the same share of `--total`. One JSON object a
line for each target; the last one has the sums. A target whose package is not installed is left out and says so. Exits
with 1 if an input has failed.
"""

import argparse
import json
import mmap
import os
import resource
import signal
import struct
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers"), str(Path(__file__).parent)]
os.environ.setdefault("JAX_PLATFORMS", "cpu")

from left_out import missing_package  # noqa: E402
from mutations import mutated  # noqa: E402
from readers import TARGETS  # noqa: E402

KEPT = Path(__file__).with_name("kept")
SLOW = 10.0  # [s], for one input
PATIENCE = 3  # times as long where the machine is busy: a reader that waits for ever uses no processor either
STUCK = 60.0  # [s], after which the process is killed
MOST = 1 << 20  # [KiB] that memory may grow by
SPARE = 4 << 30  # [bytes] of addresses beyond those in use
MEMORY = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
LONG = 3000  # characters of a message
FAILURES = 25  # of a target, after which it is left
NOTES = struct.Struct("qqqqdqd")  # next case, read, refused, failed, slowest [s], growth [KiB], spent on reading [s]


class Slow(BaseException):
    """An input takes too long."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", nargs="+", choices=list(TARGETS))
    parser.add_argument("--quick", action="store_true", help="only targets that compile no program")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="of all targets together")
    parser.add_argument("--cases", type=int, default=1 << 62, help="at most so many of each target")
    parser.add_argument("--total", type=int, default=1 << 62, help="at most so many of all targets together")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("fuzz-failures"))
    args = parser.parse_args(arguments)
    names = args.targets or [name for name, target in TARGETS.items() if target.quick or not args.quick]
    cases, seconds = min(args.cases, -(-args.total // len(names))), args.seconds / len(names)
    total = {"cases": 0, "failed": 0, "left_out": 0}
    for name in names:
        record = Hunt(name, args.seed, args.out).run(cases, seconds)
        print(json.dumps(record), flush=True)
        for key in total:
            total[key] += record.get(key, 0)
    print(json.dumps({"target": "all", **total}), flush=True)
    return int(total["failed"] > 0)


class Hunt:
    """One target: processes that read inputs, one after the other, and what became of these."""

    def __init__(self, name: str, seed: int, out: Path) -> None:
        self.name, self.target, self.seed, self.out = name, TARGETS[name], seed, out
        self.notes = mmap.mmap(-1, NOTES.size)  # shared with the process that reads
        self.failures: list[str] = []

    def run(self, cases: int, seconds: float) -> dict[str, Any]:
        """Until there are no more cases, or no more time."""
        begun, deaths, stuck = time.monotonic(), 0, False
        with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
            while self.case < cases and self.spent < seconds and deaths < FAILURES:
                place = Path(folder, str(deaths))
                place.mkdir()
                status, stuck = self.process(place, cases, seconds)
                if status == 0:
                    break
                if status == MISSING:
                    return {"target": self.name, "left_out": 1}
                if status == 1:
                    raise RuntimeError(f"{self.name} cannot be prepared")
                deaths += 1
                if status != RESTART:
                    self.keep(
                        self.case, "stuck" if stuck else f"ended by {-status}", *self.originals(Path(folder, "o"))
                    )
                    self.note(case=self.case + 1, failed=self.all()[3] + 1)
        case, read, refused, failed, slowest, growth, spent = self.all()
        ready = time.monotonic() - begun - spent
        counts = {"cases": case, "read": read, "refused": refused, "failed": failed}
        rates = {
            "per_minute": round(60 * case / max(spent, 1e-3)),
            "slowest_s": round(slowest, 2),
            "growth_mib": growth >> 10,
        }
        times = {"seconds": round(spent, 1), "getting_ready_s": round(ready, 1)}
        return {"target": self.name, "seed": self.seed, **counts, **rates, **times}

    def process(self, folder: Path, cases: int, seconds: float) -> tuple[int, bool]:
        """Exit status of a process that reads, and whether it was killed because it hung."""
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            status = 1
            try:
                status = self.hunt(folder, cases, seconds)
            except BaseException:
                traceback.print_exc()
            finally:
                os._exit(status)
        case, since = -1, time.monotonic()
        while True:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                return os.waitstatus_to_exitcode(status), False
            if self.case != case:
                case, since = self.case, time.monotonic()
            if time.monotonic() - since > STUCK + (120 if case <= 0 else 0):
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
                return -signal.SIGKILL, True
            time.sleep(0.02)

    def hunt(self, folder: Path, cases: int, seconds: float) -> int:
        """In the process that reads."""
        try:
            originals, read = self.target.prepare(folder)
        except Exception as error:
            if not missing_package(error):
                raise
            print(f"{self.name} is left out without {missing_package(error)}", file=sys.stderr, flush=True)
            return MISSING
        for original in originals:
            read(original)  # good inputs are read
        warnings.simplefilter("ignore")  # of NumPy, about odd numbers
        signal.signal(signal.SIGALRM, _too_slow)
        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (taken + SPARE, resource.RLIM_INFINITY))
        base = peak()
        if self.case == 0:
            self.again(read)
        while self.case < cases and self.spent < seconds:
            begun = time.monotonic()
            data = mutated(f"{self.name}:{self.seed}", self.case, originals, self.target.kinds)
            forget_peak()  # making an input of 600 MB takes more than reading it
            self.one(data, read, base + (len(data) >> 10))
            self.note(spent=self.spent + time.monotonic() - begun)
            if peak() - base > MOST:
                return RESTART
        return 0

    def one(self, data: bytes, read: Any, base: int) -> None:
        """Reads the next input."""
        case, num_read, refused, failed, slowest, growth, _ = self.all()
        begun = time.perf_counter()
        is_read, trouble = self.attempt(data, read, base)
        spent = time.perf_counter() - begun
        if trouble:
            self.keep(case, trouble, data)
        counts = num_read + is_read, refused + (not is_read and not trouble), failed + bool(trouble)
        self.note(case + 1, *counts, max(slowest, spent), max(growth, peak() - base))

    def attempt(self, data: bytes, read: Any, base: int) -> tuple[bool, str]:
        """Whether an input was read, and what was wrong in that."""
        is_read, trouble = False, ""
        _Clock.begun, _Clock.rings = time.process_time(), 0
        try:
            signal.setitimer(signal.ITIMER_REAL, SLOW, SLOW)
            try:
                read(data)
                is_read = True
            except self.target.refusals as error:
                trouble = faults_of(str(error))
            except Exception:
                trouble = traceback.format_exc()
            signal.setitimer(signal.ITIMER_REAL, 0)
        except Slow:  # it may come as late as in the line before
            trouble = "slow"
        except BaseException:
            trouble = traceback.format_exc()
        signal.setitimer(signal.ITIMER_REAL, 0)
        grown = peak() - base
        trouble = trouble or (f"takes {grown >> 10} MiB" if grown > MOST else "")
        return is_read and not trouble, trouble

    def again(self, read: Any) -> None:
        """Reads the inputs of this target that have failed once, see `tests/soak/kept`."""
        for path in sorted(KEPT.glob(f"{self.name}--*")):
            _, trouble = self.attempt(path.read_bytes(), read, peak())
            if trouble:
                print(f"{path.name}: {trouble}", file=sys.stderr, flush=True)
                self.note(case=self.case, failed=self.all()[3] + 1)

    def originals(self, folder: Path) -> list[bytes]:
        """The input that ended a process, made again."""
        folder.mkdir(exist_ok=True)
        originals, _ = self.target.prepare(folder)
        return [mutated(f"{self.name}:{self.seed}", self.case, originals, self.target.kinds)]

    def keep(self, case: int, trouble: str, data: bytes) -> None:
        """Writes an input that fails."""
        self.out.mkdir(parents=True, exist_ok=True)
        path = self.out / f"{self.name}-{self.seed}-{case}"
        path.write_bytes(data)
        last = trouble.strip().splitlines()
        print(f"{path}: {last[-1]:.300}", file=sys.stderr, flush=True)
        path.with_suffix(".txt").write_text(trouble)

    @property
    def case(self) -> int:
        """The next one."""
        return self.all()[0]

    @property
    def spent(self) -> float:
        """[s], on inputs so far."""
        return self.all()[6]

    def all(self) -> tuple[int, int, int, int, float, int, float]:
        """All notes."""
        return NOTES.unpack(self.notes[:])

    def note(
        self,
        case: int = -1,
        read: int = -1,
        refused: int = -1,
        failed: int = -1,
        slowest: float = -1,
        growth: int = -1,
        spent: float = -1,
    ) -> None:
        """Changes notes; those below 0 stay."""
        new = (case, read, refused, failed, slowest, growth, spent)
        self.notes[:] = NOTES.pack(*(old if x < 0 else x for x, old in zip(new, self.all(), strict=True)))


RESTART = 3  # exit statuses of a process that reads
MISSING = 4


def faults_of(message: str) -> str:
    """What is wrong with what a user is told."""
    try:
        message.encode()
    except UnicodeEncodeError as error:
        return f"message cannot be printed: {error}"
    return "message is long" if len(message) > LONG else ""


def peak() -> int:
    """[KiB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def forget_peak() -> None:
    """`peak` begins anew at what is in use, where Linux lets us."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


class _Clock:
    """Of the input that is being read."""

    begun, rings = 0.0, 0


def _too_slow(*_: object) -> None:
    _Clock.rings += 1
    if _Clock.rings >= PATIENCE or time.process_time() - _Clock.begun > SLOW / 2:
        raise Slow


if __name__ == "__main__":
    sys.exit(main())
