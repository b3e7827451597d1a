"""The command line's frame: help, mistakes, exit codes."""

import os
import subprocess
import sys

import pytest

from home_mjx.cli import ALL_COMMANDS, LOG_LEVEL_VARIABLE, main
from home_mjx.cli.parsing import Parser, parse_seed_range, positive_int_type
from home_mjx.errors import ConfigError


def run(*args: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-W", "error", "-m", "home_mjx.cli", *args]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def assert_refused(capsys: pytest.CaptureFixture, args: list[str], *words: str):
    assert main(args) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("home-mjx: error: ")
    assert err.count("\n") == 1
    assert [word for word in words if word not in err] == []


def test_help_lists_every_command_and_imports_no_jax():
    program = "import sys; from home_mjx.cli import main\ntry: main(['--help'])\nfinally: print('jax' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0
    assert [name for name in ALL_COMMANDS if f"\n  {name} " not in done.stdout] == []
    assert done.stdout.splitlines()[-1] == "False"


@pytest.mark.parametrize("command", ALL_COMMANDS)
def test_every_command_has_help(command: str, capsys: pytest.CaptureFixture):
    with pytest.raises(SystemExit) as stop:
        main([command, "--help"])
    assert stop.value.code == 0
    assert capsys.readouterr().out.startswith(f"usage: home-mjx {command} ")


def test_module_and_version():
    import home_mjx

    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"home-mjx {home_mjx.__version__}\n")


SLOW_CONSTANT = """
import sys, types
from home_mjx import cli
def run(args):
    import jax, numpy as np
    x = np.ones((44, 44), np.float32)
    jax.jit(lambda: jax.lax.reduce_window(x, 0.0, jax.lax.add, (44, 44), (1, 1), "SAME")).lower().compile()
    return 0
command = types.SimpleNamespace(run=run, add_arguments=lambda parser: None, __doc__="")
cli._load_command = lambda name: command
sys.exit(cli.main(sys.argv[1:]))
"""


def test_the_alarm_of_xla_does_not_break_bars():
    """XLA logs an alarm when it folds a constant for more than a second, as when a program compiles for minutes."""
    seen = {}
    for level in (None, "1"):
        env = {name: value for name, value in os.environ.items() if name != LOG_LEVEL_VARIABLE}
        env |= {"JAX_COMPILATION_CACHE_DIR": ""} | ({} if level is None else {LOG_LEVEL_VARIABLE: level})
        command = [sys.executable, "-c", SLOW_CONSTANT, "demo"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=env)
        assert done.returncode == 0
        seen[level] = "slow_operation_alarm" in done.stderr
    assert seen == {None: False, "1": True}


def test_no_command_shows_help_and_fails(capsys: pytest.CaptureFixture):
    assert main([]) == 2
    assert "commands:" in capsys.readouterr().out


# An option, and a command that is given no text for it: as by a variable of the shell that is not set.
NO_PATHS = [
    ("OUT", "generate", ""),
    ("--mjcf", "compile", "--mjcf", ""),
    ("--report", "compile", "--report", " "),
    ("--dataset", "inspect", "--dataset", ""),
    ("--out", "train", "PointNav", "--out", ""),
    ("--start", "train", "PointNav", "--start", ""),
    ("--episode-file", "record", "PointNav", "--episode-file", ""),
    ("CHECKPOINT", "evaluate", ""),
]


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["demoo"], ["unknown command `demoo`", "Did you mean `demo`?"]),
        (["--debgu", "demo"], ["unknown option `--debgu`", "Did you mean `--debug`?"]),
        (["doctor", "--jsn"], ["unknown option `--jsn`", "Did you mean `--json`?"]),
        (["doctor", "--jso"], ["unknown option `--jso`"]),  # no guessing of abbreviations
        (["doctor", "now"], ["unexpected argument `now`"]),
        (["generate"], ["OUT", "home-mjx generate --help"]),
        (["generate", "x", "--seeds", "3:3"], ["expected 0 <= A < B", "`3:3`"]),
        (["generate", "x", "--seeds", "-3:2"], ["expected 0 <= A < B", "`-3:2`"]),
        (["render", "--at", "-1e-3:", "0"], ["expected a number", "`-1e-3:`"]),
        (["render", "--yaw", "-inf"], ["expected a number", "`-inf`"]),
        (["play", "PointNav", "--houses", "-.5"], ["expected a whole number above 0", "`-.5`"]),
        (["train", "PointNav", "--sensors", "state,,goal"], ["expected names separated by commas", "`state,,goal`"]),
        (["render", "--sensors", "rbg"], ["unknown kind of image `rbg`", "Did you mean `rgb`?"]),
        (["play", "PointNav", "--sensors", "dept"], ["unknown sensor `dept`", "Did you mean `depth`?"]),
        (["render", "--dataset", "procedual:2"], ["no dataset has the scheme `procedual:`", "`procedural`"]),
        (["render", "procedural:x"], ["`procedural:x` does not name generated houses"]),
        (["bench", "rayz"], ["unknown benchmark case `rayz`", "Did you mean `rays`?"]),
        (["bench", "rays/primary"], ["unknown benchmark measurement", "Did you mean `primary-depth`?"]),
        (["bench", "rays", "--envs", "0"], ["`num_envs` must be a whole number of at least 1"]),
        (["generate", "x", "--seeds", "99999999999999999999"], ["2**63"]),
        (["demo", "--seed", "99999999999999999999"], ["whole number from 0 to 4294967295"]),
        (["generate", "x", "--seeds", "0:99999999999"], ["--seeds", "at most 1000000 houses", "`0:99999999999`"]),
        (["play", "PointNav", "--houses", "99999999"], ["--houses", "at most 1000000"]),
        (["play", "PointNav", "--size", "100000", "9"], ["--size", "at most 8192"]),
        (["compile", "--workers", "1000000"], ["--workers", "at most 1024"]),
        *((args, [name, "expected a path, got '"]) for name, *args in NO_PATHS),
        (["demo", "--seed", "-1"], ["whole number from 0 to 4294967295"]),
        (["inspect", "--dataset", "no/such/folder"], ["no/such/folder"]),
        (["compile", "no/such/folder"], ["no/such/folder", "dataset root is not a folder"]),
        (["compile", "--mjcf", "x", "--collision", "bogus"], ["bogus", "box", "exact"]),
        (["compile", "--collision", "bogus"], ["bogus", "box", "exact"]),
        (["render", "--at", "nan", "0"], ["expected a number", "`nan`"]),
        (["render", "--at", "0", "1e9"], ["expected a number", "`1e9`"]),
        (["render", "--yaw", "inf"], ["expected a number", "`inf`"]),
        (["listen", "--source", "0", "nan", "0"], ["expected a number", "`nan`"]),
        *((["render", "--fovy", text], ["expected a number from 1 to 179"]) for text in ("0", "-30", "400", "nan")),
    ],
)
def test_bad_input_is_one_message_and_code_2(args: list[str], words: list[str], capsys: pytest.CaptureFixture):
    assert_refused(capsys, args, *words)


def test_unusable_output_folder_is_one_message(tmp_path, capsys: pytest.CaptureFixture):
    (tmp_path / "file").write_text("not a folder")
    assert_refused(capsys, ["generate", str(tmp_path / "file"), "--seeds", "0"], str(tmp_path / "file"))


@pytest.mark.parametrize("command", ["demo", "render", "listen"])
def test_unusable_output_folder_is_found_before_the_work(command: str, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("home_mjx.cli.viewpoint.load_compiled_house", None)  # nothing is compiled,
    monkeypatch.setattr("home_mjx.viewer.demo.run.run_demo", None)  # and nobody walks
    (tmp_path / "file").write_text("not a folder")
    for out in (tmp_path / "file", tmp_path / "file" / "below"):
        assert_refused(capsys, [command, "--out", str(out)], str(out), "--out")


def test_who_is_refused_after_the_folder_was_made_leaves_none(tmp_path, monkeypatch, capsys):
    def refuse(*_: object) -> None:
        raise ConfigError("nobody is at home")

    monkeypatch.setattr("home_mjx.viewer.demo.run.run_demo", refuse)
    assert_refused(capsys, ["demo", "--out", str(tmp_path / "new" / "below")], "nobody is at home")
    assert list(tmp_path.iterdir()) == []


def test_films_of_an_evaluation_are_refused_before_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("home_mjx.training.evaluate_checkpoint", None)  # nobody plays
    (tmp_path / "file").write_text("not a folder")
    assert_refused(capsys, ["evaluate", "demo", "--films", "1", "--out", str(tmp_path / "file")], "--out")


@pytest.mark.parametrize("args", [["--debug", "demoo"], ["inspect", "--debug", "--dataset", "no/such/folder"]])
def test_debug_shows_the_traceback(args: list[str]):
    done = run(*args)
    assert done.returncode == 1
    assert done.stderr.startswith("Traceback")


def test_error_leaves_no_traceback_in_a_real_process():
    done = run("inspect", "--dataset", "no/such/folder")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def test_seed_range():
    assert list(parse_seed_range("3:6")) == [3, 4, 5]
    assert list(parse_seed_range("7")) == [7]


def test_positive_int_refuses_what_is_not():
    parser = Parser(prog="p")
    parser.add_argument("--n", type=positive_int_type)
    assert parser.parse_args(["--n", "12"]).n == 12
    for text in ("0", "-1", "1.5", "x", "2147483648", "1" + "0" * 5000):
        with pytest.raises(ConfigError, match="whole number above 0"):
            parser.parse_args(["--n", text])


@pytest.mark.parametrize("error", [MemoryError("Unable to allocate 3 TiB"), "RESOURCE_EXHAUSTED: Out of memory.\nAt"])
def test_too_little_memory_is_one_message(error, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture):
    """JAX's own kind of error is told by its name: JAX may not have been imported."""
    raised = type("JaxRuntimeError", (RuntimeError,), {})(error) if isinstance(error, str) else error

    def run(args: object) -> None:
        raise raised

    monkeypatch.setattr("home_mjx.cli.commands.generate.run", run)
    assert_refused(capsys, ["generate", "x", "--seeds", "0"], "not enough memory", "Use fewer environments")
    with pytest.raises(type(raised)):
        main(["generate", "x", "--seeds", "0", "--debug"])


def test_benchmarks_outside_the_repository_are_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("home_mjx.cli.CHECKOUT", tmp_path)
    assert_refused(capsys, ["bench", "rays"], "part of the repository", "Clone the repository")
