"""Numba's cache on disk: a damaged file of machine code is compiled anew and never run."""

import gc
import importlib.util
import itertools
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from home_mjx.core.native import numba_cache as kept

SOURCE = """
from numba import cfunc, types
from home_mjx.core.native.numba_cache import verify_cache

@verify_cache
def build():
    @cfunc(types.intp(types.intp), cache=True)
    def double(x):
        return 2 * x
    return double
"""


@pytest.fixture
def build(tmp_path: Path, monkeypatch):
    """Return `build` of a module that can be imported, as Numba does while it loads code."""
    (tmp_path / "code.py").write_text(SOURCE)
    spec = importlib.util.spec_from_file_location("code_of_a_test", tmp_path / "code.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "code_of_a_test", module)
    spec.loader.exec_module(module)
    return module.build


def files(tmp_path: Path) -> list[Path]:
    return sorted((tmp_path / "__pycache__").glob("code.*.nb[ic]"))


def test_sound_code_is_loaded(build, tmp_path):
    assert build().cache_hits == 0
    assert len(files(tmp_path)) == 2
    gc.collect()  # Numba then keeps nothing of the first build in memory
    assert build().cache_hits == 1


@pytest.mark.parametrize("damage", ["flip", "cut", "empty", "not noted"])
@pytest.mark.parametrize("which", [0, 1], ids=["code", "index"])
def test_damaged_code_is_made_again(build, tmp_path, damage, which):
    build()
    path = files(tmp_path)[which]
    data = bytearray(path.read_bytes())
    if damage == "flip":
        data[len(data) // 2] ^= 0x55
    path.write_bytes({"cut": data[: len(data) // 2], "empty": b""}.get(damage, data))
    if damage == "not noted":
        (tmp_path / "__pycache__" / "code.sha256.json").write_text("[")
    again = build()
    assert (again.cache_hits, again.ctypes(21)) == (0, 42)
    assert build().cache_hits == 1


def test_a_folder_that_cannot_be_written_to_only_costs_time(build, monkeypatch):
    def nowhere(*_: object):
        raise RuntimeError("cannot cache: no locator available")

    monkeypatch.setattr("home_mjx.core.native.numba_cache.FunctionCache", nowhere)
    assert build().ctypes(4) == 8


def test_code_of_the_compiler_of_houses_is_checked_once(monkeypatch):
    """Its functions are called for every model."""
    checks = []
    monkeypatch.setattr(kept, "delete_unverified", lambda *place: checks.append(place))
    double = kept.verify_cache_once(lambda x: 2 * x)
    monkeypatch.setattr(kept, "_place", lambda _: (Path("/nowhere"), "code"))
    assert [double(x) for x in (1, 2, 3)] == [2, 4, 6]
    assert len(checks) == 1


def test_one_compiles_while_the_others_wait(tmp_path, monkeypatch):
    """Eight at once: of their stretches no two overlap, and none is left out."""
    stretches = []

    def build():
        begun = time.monotonic()
        time.sleep(0.02)
        stretches.append((begun, time.monotonic()))

    monkeypatch.setattr(kept, "_place", lambda _: (tmp_path, "code"))
    monkeypatch.setattr(kept, "POLL_SECONDS", 0.001)
    threads = [threading.Thread(target=kept.verify_cache(build)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    stretches.sort()
    assert len(stretches) == 8
    assert all(end <= begin for (_, end), (begin, _) in itertools.pairwise(stretches))


HOLDS = """
import fcntl, sys
file = open(sys.argv[1], "ab")
fcntl.flock(file, fcntl.LOCK_EX)
print("held", flush=True)
sys.stdin.read()
"""


def test_who_is_killed_or_stuck_holds_nobody_up_for_long(tmp_path, monkeypatch):
    lock = tmp_path / "code.lock"
    with subprocess.Popen([sys.executable, "-c", HOLDS, lock], stdin=-1, stdout=-1) as holder:
        assert holder.stdout.readline() == b"held\n"
        monkeypatch.setattr(kept, "MAX_LOCK_WAIT_SECONDS", 0.3)
        begun = time.monotonic()
        with kept.exclusive_lock(lock):
            assert 0.3 <= time.monotonic() - begun < 5
        monkeypatch.setattr(kept, "MAX_LOCK_WAIT_SECONDS", 60)
        threading.Timer(0.2, holder.kill).start()
        begun = time.monotonic()
        with kept.exclusive_lock(lock):
            assert 0.1 < time.monotonic() - begun < 10
