"""Ctrl-C and SIGTERM: code 130 or 143 and one line within seconds, at any instant."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from processes import processes_of, wait_for

# One call that lasts minutes without the interpreter's lock, as a compilation by XLA does.
STUCK = "hashlib.pbkdf2_hmac('sha256', b'', b'', 10**9)"
START = "import hashlib, time; from home_mjx.cli.interrupts import watch_interrupts; watch_interrupts()\n"
SECONDS = 10  # a command ends in less
LINES = {signal.SIGINT: "home-mjx: interrupted\n", signal.SIGTERM: "home-mjx: terminated\n"}


def started(folder: Path, program: str) -> subprocess.Popen:
    """A Python of its own process group. A parent in the background may have had it ignore SIGINT: undone here."""
    undo = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    with (folder / "err").open("w") as err:
        return subprocess.Popen(
            [sys.executable, "-c", undo + program],
            stdout=subprocess.PIPE,
            stderr=err,
            start_new_session=True,
            env={**os.environ, "HOME_MJX_CACHE": str(folder / "cache"), "JAX_COMPILATION_CACHE_DIR": ""},
        )


def interrupt(process: subprocess.Popen) -> None:
    os.killpg(process.pid, signal.SIGINT)


def assert_ends(process: subprocess.Popen, folder: Path, number: int = signal.SIGINT) -> None:
    line = LINES[signal.Signals(number)]
    try:
        assert process.wait(SECONDS) == 128 + number
        err = (folder / "err").read_text()
        assert err.endswith(line)
        assert err.count(line) == 1
        assert "Traceback" not in err
    finally:
        process.kill()
        assert process.stdout is not None
        process.stdout.close()


def wait_until_ready(process: subprocess.Popen) -> None:
    assert process.stdout is not None
    assert process.stdout.readline() == b"ready\n"
    time.sleep(0.2)


def test_an_interrupt_ends_a_call_that_does_not_return_to_python(tmp_path: Path):
    process = started(tmp_path, f"{START}print('ready', flush=True)\n{STUCK}")
    wait_until_ready(process)
    interrupt(process)
    assert_ends(process, tmp_path)


def test_a_second_interrupt_ends_what_cleans_up_after_the_first(tmp_path: Path):
    program = f"{START}try:\n    print('ready', flush=True)\n    time.sleep(600)\nfinally:\n"
    process = started(tmp_path, f"{program}    print('ready', flush=True)\n    {STUCK}")
    wait_until_ready(process)
    interrupt(process)
    wait_until_ready(process)
    time.sleep(1.5)  # the first alone lets it clean up
    assert process.poll() is None
    interrupt(process)
    assert_ends(process, tmp_path)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_open_work_is_completed_before_a_command_ends(tmp_path: Path, number: int):
    """SIGTERM ended the process at once, and the open episode of a recording was lost."""
    command = "def run(argv):\n    try:\n        print('ready', flush=True); time.sleep(600)\n"
    close = "    finally:\n        print('closed', flush=True)\n"
    program = f"import sys, time, home_mjx.cli as cli\n{command}{close}cli._dispatch = run; sys.exit(cli.main())"
    process = started(tmp_path, program)
    wait_until_ready(process)
    os.kill(process.pid, number)
    assert process.stdout is not None
    assert process.stdout.readline() == b"closed\n"
    assert_ends(process, tmp_path, number)


def test_an_ignored_interrupt_stays_ignored(tmp_path: Path):
    ignore = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
    process = started(tmp_path, f"{ignore}{START}print('ready', flush=True)\ntime.sleep(2)\nprint('done')")
    wait_until_ready(process)
    interrupt(process)
    out, _ = process.communicate(timeout=60)
    assert (process.returncode, out) == (0, b"done\n")


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [1, 6, 15])
def test_the_demo_can_be_interrupted_while_it_compiles(tmp_path: Path, seconds: float):
    """It used to end by a segmentation fault while it was lowered, or 40 s later while XLA compiled."""
    args = ["home-mjx", "demo", "--houses", "1", "--envs", "2", "--out", str(tmp_path / "out")]
    process = started(tmp_path, f"import sys; from home_mjx.cli import main; sys.argv = {args}; sys.exit(main())")
    wait_for(lambda: "| 1/156" in (tmp_path / "err").read_text(), 240)
    time.sleep(seconds)
    interrupt(process)
    assert_ends(process, tmp_path)
    wait_for(lambda: not processes_of(tmp_path))
