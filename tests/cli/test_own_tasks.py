"""Tasks of the user's own on the command line: named by an argument, never by a file."""

import argparse
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import gymnasium
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx import registry
from home_mjx.cli import main
from home_mjx.cli.learning import evaluate, play, record, train
from home_mjx.cli.learning.arguments import find_checkpoint, import_modules, parse_checkpoint_path, task_spec
from home_mjx.errors import ConfigError
from home_mjx.training import CPU_CONFIG, RunConfig, read_config, save_net

MODULE = "tasks_of_a_user"
SOURCE = """
from dataclasses import dataclass

import home_mjx
from home_mjx.tasks.suite import PointNav


@dataclass(frozen=True)
class NearPoint(PointNav):
    "PointNav that is soon over."

    success_distance: float = 1.0


home_mjx.register("NearPoint-v0", NearPoint, {"ctrl_dt": 0.3})
home_mjx.register("NearPoint-v1", NearPoint)
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with modules of a user, where commands are called; what they register is forgotten again."""
    (tmp_path / f"{MODULE}.py").write_text(SOURCE)
    (tmp_path / "broken_task.py").write_text("import home_mjx\n1 / 0\n")
    (tmp_path / "taken_task.py").write_text("import home_mjx\nhome_mjx.register('PointNav-v0', print)\n")
    (tmp_path / "json.py").write_text("raise RuntimeError\n")  # takes no place of Python's own
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield tmp_path
    sys.modules.pop(MODULE, None)
    for version in (0, 1):
        registry._REGISTRY.pop(f"NearPoint-v{version}", None)
        gymnasium.registry.pop(f"home_mjx/NearPoint-v{version}", None)
    registry._LOCAL_ENTRY_POINTS.pop(f"{MODULE}:NearPoint", None)


def parsed(command: object, *args: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    command.add_arguments(parser)
    return parser.parse_args(args)


def checkpoint(folder: Path) -> Path:
    """Of an agent for the user's task; its module is not imported any more."""
    import_modules([MODULE])
    save_net(folder / "agent.npz", {}, RunConfig(registry.find_spec("NearPoint-v1"), CPU_CONFIG))
    sys.modules.pop(MODULE)
    for version in (0, 1):
        registry._REGISTRY.pop(f"NearPoint-v{version}")
    return folder / "agent.npz"


def test_a_task_is_named_by_module_and_id():
    config = train.run_config(parsed(train, f"{MODULE}:NearPoint", "--houses", "2"))
    assert (config.env.id, config.env.entry_point) == ("NearPoint-v1", f"{MODULE}:NearPoint")
    assert task_spec(f"{MODULE}:NearPoint-v0").options == {"ctrl_dt": 0.3}
    assert play.env_spec(parsed(play, f"{MODULE}:NearPoint"), None, ("state",)).id == "NearPoint-v1"
    assert task_spec("NearPoint") == task_spec(f"{MODULE}:NearPoint")  # it is imported now


@pytest.mark.parametrize("command", [play, record, evaluate], ids=lambda module: module.__name__)
def test_a_checkpoint_of_an_own_task_needs_its_module_by_argument(folder: Path, command, capsys):
    path = checkpoint(folder)
    name = command.__name__.rpartition(".")[2]
    args = [name, *(["--checkpoint"] if command is not evaluate else []), str(path)]
    args += ["--agent", "trained"] if command is not evaluate else []
    assert main(args) == 2
    message = capsys.readouterr().err
    assert "no environment `NearPoint-v1` of `tasks_of_a_user:NearPoint` is registered" in message
    assert "--import MODULE" in message
    assert MODULE not in sys.modules
    import_modules(parsed(command, *args[1:], "--import", MODULE).modules)
    assert read_config(path).env.id == "NearPoint-v1"


@pytest.mark.parametrize(
    ("task", "words"),
    [
        ("no_such_module:NearPoint", "module `no_such_module` cannot be imported: ModuleNotFoundError"),
        ("tasks_of_a_user.py:NearPoint", "Use its import name"),
        (":NearPoint", "module `` cannot be imported"),
        ("..:NearPoint", "cannot be imported"),
        ("broken_task:NearPoint", "ZeroDivisionError: division by zero"),
        ("taken_task:NearPoint", "environment id `PointNav-v0` is taken"),
        (f"{MODULE}:NearPont", "Did you mean `NearPoint-v"),
        (f"{MODULE}:", "unknown environment ``"),
    ],
)
def test_a_module_that_cannot_be_used_is_one_message(task: str, words: str, capsys: pytest.CaptureFixture):
    for command in ("train", "play", "record"):
        assert main([command, task]) == 2
        message = capsys.readouterr().err
        assert words in message
        assert message.count("\n") == 1
    assert list(Path().glob("runs*")) == []


def test_the_agent_in_the_box_has_a_name(folder: Path):
    path = parse_checkpoint_path("demo")
    assert path.is_file()
    assert read_config(path).env.id == "AudioNav-v0"
    assert str(parse_checkpoint_path("./demo")) == "demo"  # a folder of the user's
    (folder / "demo").mkdir()
    assert parse_checkpoint_path("demo") == path
    assert parsed(evaluate, "demo").checkpoint == parsed(play, "--checkpoint", "demo").checkpoint == path
    assert train.run_config(parsed(train, "PointNav", "--start", "demo")).start == str(path)
    assert find_checkpoint(folder) == folder / "checkpoint.npz"


def test_modules_of_this_folder_do_not_hide_installed_ones():
    with pytest.raises(ConfigError, match="no_such_module"):
        import_modules(["json", "no_such_module"])
    assert sys.path[-1] == os.getcwd()


@pytest.mark.slow
def test_an_own_task_is_trained_and_evaluated_by_the_command(folder: Path):
    """In processes of their own, as users call them: the script's folder is on the path, this one is not."""
    call = [sys.executable, "-c", "import sys; sys.path.remove(''); from home_mjx.cli import main; sys.exit(main())"]
    small = ["--ppo", "network.features=16", "--ppo", "network.memory=16", "--ppo", "unroll_length=8"]
    options = ["--houses", "2", "--held-out", "1", "--num-envs", "8", "--steps", "128", "--episodes", "4"]
    env = ["--env", "impl=kinematic", "--env", "episode_length=8"]
    root = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    for args in (
        ["train", f"{MODULE}:NearPoint", *options, *small, *env, "--out", "out"],
        ["evaluate", "out", "--import", MODULE, "--episodes", "4", "--houses", "1"],
        ["play", "--checkpoint", "out/agent.npz", "--import", MODULE, "--episodes", "1", "--houses", "1", "--no-film"],
    ):
        done = subprocess.run([*call, *args], capture_output=True, text=True, timeout=580, env=root, check=False)
        assert done.returncode == 0, done.stderr[-2000:]
    assert "8 steps" in done.stdout + done.stderr
