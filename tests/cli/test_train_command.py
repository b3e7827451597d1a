"""`home-mjx train` and `evaluate`: files, refusals, and going on after a kill."""

import argparse
import dataclasses
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("tensorboardX", reason="needs the extra `train`")

from generated import generate_flats
from processes import wait_for

from home_mjx.cli import main
from home_mjx.cli.learning import play
from home_mjx.cli.learning.arguments import newest_version
from home_mjx.cli.learning.train import add_arguments, run_config
from home_mjx.core.jsonable import parse_assignments
from home_mjx.datasets.splits import split_of
from home_mjx.registry import find_spec
from home_mjx.training import CPU_CONFIG, RunConfig, evaluation_spec, save_net
from home_mjx.training.checkpoint import read_config

NETWORK = ["--ppo", "network.features=16", "--ppo", "network.memory=16"]


@pytest.fixture(scope="module")
def houses(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset with houses of both parts."""
    root = tmp_path_factory.mktemp("houses")
    ids = generate_flats(root, range(12))
    assert {split_of(house) for house in ids} >= {"train", "val"}
    return root


def command(houses: Path, out: Path, *more: str) -> list[str]:
    return [
        "train", "PointNav", "--dataset", str(houses), "--houses", "2", "--num-envs", "8", "--steps", "2560",
        "--episodes", "8", "--env", "episode_length=8", "--ppo", "unroll_length=8", *NETWORK, "--out", str(out), *more,
    ]  # fmt: skip


def arrays(out: Path) -> dict[str, np.ndarray]:
    with np.load(out / "checkpoint.npz") as file:
        return {name: file[name] for name in file.files}


def test_options_are_numbers_or_text():
    given = ["width=32", "actions=discrete", "stop=true", "sizes=[1, 2]", "name=a=b"]
    wanted = {"width": 32, "actions": "discrete", "stop": True, "sizes": [1, 2], "name": "a=b"}
    assert parse_assignments(given) == wanted
    assert newest_version("PointNav") == "PointNav-v0"


def test_mistakes_are_refused_before_any_house_is_made(tmp_path: Path, capsys: pytest.CaptureFixture):
    for args, words in (
        (["train", "PointNaw"], "Did you mean `PointNav-v0`?"),
        (["train", "PointNav", "--ppo", "num_env=3"], "Did you mean `num_envs`?"),
        (["train", "PointNav", "--ppo", "discount=2"], "`discount` must be"),
        (["train", "PointNav", "--steps", "1000000000000000"], "gradient steps, the maximum is 2147483647"),
        (["train", "PointNav", "--clone-steps", "1000000000000000"], "gradient steps, the maximum is 2147483647"),
        (["train", "PointNav", "--steps", "1" + "0" * 400], "expected a whole number above 0 and at most 10"),
        (["train", "PointNav", "--ppo", "num_timesteps=1" + "0" * 400], "`num_timesteps` must be a whole number"),
        (["train", "PointNav", "--ppo", "discount=1" + "0" * 400], "`discount` must be"),
        (["train", "PointNav", "--env", "width=" + "[" * 100_000], "`width` has too deeply nested brackets"),
        (["train", "PointNav", "--env", "width"], "expected NAME=VALUE, got `width`"),
        (["train", "PointNav", "--seconds", "0"], "`max_seconds` must be a finite number of at least 0.001"),
        (["train", "PointNav", "--seconds", "nan"], "`max_seconds` must be"),
        (["train", "PointNav", "--episodes", "2000000"], "`num_episodes` must be"),
        (["train", "PointNav", "--start", str(tmp_path / "none")], "there is no checkpoint"),
        (["evaluate", "demo", "--episodes", "10000000000000"], "at most 2147483647"),
        (["evaluate", "demo", "--episodes", "2000000"], "`num_episodes` must be"),
        (["play", "PointNav", "--no-film", "--episodes", "2000000"], "`num_episodes` must be"),
        (["evaluate", str(tmp_path)], "Pass the folder of a `home-mjx train` run"),
        (["evaluate", str(tmp_path)], "there is no checkpoint"),
    ):
        assert main([*args, *(["--out", str(tmp_path / "out")] if args[0] == "train" else [])]) == 2
        message = capsys.readouterr().err
        assert words in message
        assert len(message) < 500
        assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_agents_play_by_the_rules_whatever_made_learning_easier(tmp_path: Path):
    """Also in houses that they have trained in, and where a file says which episodes."""
    options = {"stop": True, "terminate_on_failure": False, "episodes": "trained.jsonl"}
    spec = dataclasses.replace(find_spec("ObjectNav-v0"), options=options, num_houses=3, split="train")
    save_net(tmp_path / "agent.npz", {}, RunConfig(spec, CPU_CONFIG))
    parser = argparse.ArgumentParser()
    play.add_arguments(parser)
    for args, wanted in (
        ([], {"stop": True}),
        (["--env", "terminate_on_failure=false"], {"stop": True, "terminate_on_failure": False}),
        (["--episode-file", "val.jsonl"], {"stop": True, "episodes": "val.jsonl"}),
    ):
        assert play.env_spec(parser.parse_args(args), tmp_path / "agent.npz").options == wanted
    same = evaluation_spec(spec, None)
    assert (same.options, same.split, same.num_houses) == (
        {"stop": True, "episodes": "trained.jsonl"}, "train", 3,
    )  # fmt: skip
    told = evaluation_spec(spec, episode_file="val.jsonl", dataset="suncg")
    assert (told.options, told.houses) == ({"stop": True, "episodes": "val.jsonl"}, "suncg")


@pytest.mark.slow
def test_a_killed_run_goes_on_as_if_it_had_not_been(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    assert main(command(houses, whole)) == 0
    table = capsys.readouterr().out
    assert [word for word in ("trained", "random", "8 episodes") if word not in table] == []
    report = json.loads((whole / "evaluation.json").read_text())
    assert report["split"] == "val"
    assert {"success", "spl", "soft_spl", "return", "episode_steps"} <= set(report["trained"])
    assert read_config(whole / "checkpoint.npz").env.split == "train"
    assert {path.name for path in whole.iterdir()} == {
        "agent.npz", "checkpoint.npz", "curves.png", "evaluation.json", "metrics.jsonl", "tensorboard",
    }  # fmt: skip

    program = [sys.executable, "-m", "home_mjx.cli", *command(houses, killed)]
    process = subprocess.Popen(program, stderr=subprocess.DEVNULL)
    wait_for((killed / "checkpoint.npz").exists, 300)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert int(arrays(killed)[".updates"]) <= 40
    assert main(command(houses, killed)) == 2
    assert "--resume" in capsys.readouterr().err
    assert main([*command(houses, killed, "--resume", "--seed", "1")]) == 2
    assert "`seed` is 0 there, 1 here" in capsys.readouterr().err
    assert main(command(houses, killed, "--resume")) == 0

    one, other = arrays(whole), arrays(killed)
    assert one.keys() == other.keys()
    assert [name for name in one if not np.array_equal(one[name], other[name])] == []
    lines = [[json.loads(text) for text in (out / "metrics.jsonl").read_text().splitlines()] for out in (whole, killed)]
    timed = ("seconds", "compile_seconds", "steps_per_second")
    plain = [[{k: v for k, v in line.items() if k not in timed} for line in file] for file in lines]
    assert plain[0] == plain[1]
    assert [line["steps"] for line in lines[0]] == list(range(64, 2561, 64))
    seconds = [line["seconds"] for line in lines[1]]
    assert seconds == sorted(seconds)


@pytest.mark.slow
def test_a_trained_agent_is_filmed_and_gone_on_with(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    clone, tuned = tmp_path / "clone", tmp_path / "tuned"
    assert main(command(houses, clone, "--algorithm", "clone", "--steps", "256")) == 0
    assert "agreement" in (clone / "metrics.jsonl").read_text()
    film = ["play", "--checkpoint", str(clone), "--episodes", "2", "--houses", "1", "--size", "64", "48"]
    capsys.readouterr()
    assert main([*film, "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out.count("8 steps") == 2
    assert (tmp_path / "PointNav-v0_trained.mp4").stat().st_size > 1000
    assert main([*film, "--agent", "expert"]) == 2
    assert main(command(houses, tuned, "--start", str(clone), "--ppo", "learning_rate=0", "--steps", "64")) == 0
    one, other = arrays(clone), arrays(tuned)
    nets = [name for name in one if name.startswith(".net")]
    assert nets
    assert all(np.array_equal(one[name], other[name]) for name in nets)
    assert main(command(houses, tmp_path / "third", "--start", str(clone), "--sensors", "goal")) == 2
    assert "expected float32" in capsys.readouterr().err


@pytest.mark.slow
def test_evaluate_plays_what_was_trained(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    out = tmp_path / "run"
    assert main(command(houses, out)) == 0
    capsys.readouterr()
    reports = []
    for options in (["--greedy"], ["--greedy"], []):
        assert main(["evaluate", str(out), "--episodes", "8", "--houses", "1", "--json", *options]) == 0
        reports.append(json.loads(capsys.readouterr().out))
    assert reports[0]["trained"] == reports[1]["trained"] != reports[2]["trained"]
    assert reports[0]["random"] == reports[2]["random"]
    assert reports[0]["houses"] == 1
    assert [report["actions"] for report in reports] == ["greedy", "greedy", "sampled"]


def test_a_run_has_all_options():
    houses, parser = Path("houses"), argparse.ArgumentParser()
    add_arguments(parser)
    config = run_config(parser.parse_args(command(houses, Path("out"), "--seed", "5")[1:]))
    assert config.env.houses == str(houses)
    assert (config.env.num_houses, config.env.split, config.seed) == (2, "train", 5)
    assert config.env.options == {"sensors": ("state", "goal"), "episode_length": 8}
    assert (config.ppo.num_envs, config.ppo.num_timesteps, config.ppo.network.memory) == (8, 2560, 16)
    assert (config.clone_timesteps, config.max_seconds) == (0, None)
    more = command(houses, Path("out"), "--clone-steps", "640", "--seconds", "7.5", "--algorithm", "advised")
    config = run_config(parser.parse_args(more[1:]))
    assert (config.clone_timesteps, config.max_seconds, config.algorithm) == (640, 7.5, "advised")


def test_houses_of_the_evaluation_are_looked_for_before_training(tmp_path, capsys):
    out = tmp_path / "run"
    assert (
        main(
            ["train", "PointNav", "--dataset", "procedural:2?seed=5&preset=flat", "--steps", "1024", "--out", str(out)]
        )
        == 2
    )
    assert "none of its 2 houses are in the split `val`" in capsys.readouterr().err
    assert not out.exists()
