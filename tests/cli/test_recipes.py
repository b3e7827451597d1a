"""Recipes: each is a valid training; what a user changes counts and is said; broken ones are refused."""

import dataclasses
import json
import re
from pathlib import Path
from types import SimpleNamespace

import jax
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.cli import main
from home_mjx.cli.learning import train
from home_mjx.cli.learning.recipes import changed_options, list_recipes, plain_value, read_recipe
from home_mjx.cli.learning.results import format_card
from home_mjx.cli.parsing import Parser
from home_mjx.env_factory import make_core
from home_mjx.training.networks import NetworkConfig
from home_mjx.training.ppo import PPO
from home_mjx.training.run import LEARNERS, make_env
from home_mjx.viewer.demo.search import AGENT_FILE


def parse(*argv: str):
    parser = Parser()
    train.add_arguments(parser)
    return parser.parse_args(train.expand_arguments(list(argv)))


@pytest.mark.parametrize("name", list_recipes())
def test_each_recipe_is_a_training_and_its_evaluations_fit(name: str):
    recipe, args = read_recipe(name), parse("--recipe", name)
    run = train.run_config(args)
    assert run.env.num_houses == recipe.arguments["houses"]
    assert {key: run.env.options[key] for key in recipe.env} == recipe.env
    core = make_core(run.env)
    PPO(core, run.ppo)  # has a network for each observation
    assert recipe.evaluate
    assert set(recipe.expected) <= set(recipe.evaluate)
    assert not recipe.curve or recipe.expected
    for options in recipe.evaluate.values():
        changed = {key: plain_value(value) for key, value in options.items()}
        make_core(dataclasses.replace(run.env, options={**run.env.options, **changed}))
    assert list(changed_options(args, recipe, train.add_arguments)) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", list_recipes())
def test_each_recipe_takes_a_tiny_update(name: str):
    """In one small flat, with its own sensors, task options and loss; all numbers are finite."""
    run = train.run_config(parse("--recipe", name))
    env = make_env(dataclasses.replace(run.env, houses="procedural:1?preset=flat", num_houses=1, split=None))
    small = NetworkConfig(features=8, memory=8, channels=(4,))
    changed = {"num_envs": 2, "unroll_length": 2, "num_timesteps": 8, "num_minibatches": 1, "network": small}
    ppo = LEARNERS[run.algorithm](env.core, dataclasses.replace(run.ppo, **changed), jax.devices()[:1])
    state, metrics = ppo.update(env.params, ppo.init(env.params, jax.random.key(0)))
    assert np.isfinite([float(x) for x in metrics.values()]).all()
    assert int(state.updates) == 1


def test_changed_options_count_and_are_said():
    """Before and after `--recipe`, also where the new value is the command's default."""
    args = parse(
        "--houses=32", "--recipe=audionav-unheard", "--env", "clip_split=heard", "--ppo", "memory=64", "--seed=1"
    )
    assert (args.houses, args.seed, args.steps) == (32, 1, 40_000_000)
    recipe = read_recipe("audionav-unheard")
    assert set(changed_options(args, recipe, train.add_arguments)) == {
        "houses: 32 instead of 256",
        "seed: 1 instead of 8",
        "env clip_split: heard instead of training",
        "ppo memory: 64 instead of 384",
    }


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ('task = "PointNav"\nstepz = 4', "stepz"),
        ("steps = 4", "task"),
        ("task = ", "not TOML"),
        ('task = "PointNav"\nenv = 3', "table"),
        ('task = "PointNav"\n[expected]\nval = 0.5', "expected.val"),
        ('task = "PointNav"\ncurve = [[10, 0.5], [5, 0.6]]', "growing steps"),
        ('task = "PointNav"\ncurve = [[10, "much"]]', "pairs of steps"),
        ('task = "PointNav"\nagent = 3', "name of a checkpoint"),
    ],
)
def test_broken_recipes_are_refused(text: str, named: str, tmp_path: Path, capsys: pytest.CaptureFixture):
    path = tmp_path / "own.toml"
    path.write_text(text)
    assert main(["train", "--recipe", str(path)]) == 2
    said = capsys.readouterr().err
    assert "own.toml" in said
    assert named in said


def test_unknown_names_are_refused(capsys: pytest.CaptureFixture):
    assert main(["train", "--recipe", "objektnav"]) == 2
    assert "Did you mean `objectnav`" in capsys.readouterr().err


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[SimpleNamespace]:
    """Evaluations that were asked for, of which none is run; in a folder without runs."""
    monkeypatch.chdir(tmp_path)
    given = []

    def judge(path, split, houses, episodes, *more, dataset, options):
        given.append(SimpleNamespace(path=path, houses=houses, episodes=episodes, options=options))
        figures = {"success": {"mean": 0.625, "stderr": 0.01}, "spl": {"mean": 0.5, "stderr": 0.01}}
        return {"trained": figures, "random": {"success": {"mean": 0.0, "stderr": 0.0}}}

    monkeypatch.setattr("home_mjx.training.evaluate_checkpoint", judge)
    return given


def test_all_evaluations_of_a_recipe_are_printed(judged, capsys: pytest.CaptureFixture):
    """Each with its own options, of the published agent or of the user's run; a number of houses that is given counts.

    The table has every recipe: those without an agent here with their expected results.
    """
    assert main(["evaluate", "--recipe", "all", "--episodes", "7"]) == 0
    assert [one.options["clip_split"] for one in judged] == ["held_out", "unheard", "training", "held_out"]
    assert [one.options["variation"] for one in judged] == [None, None, None, {"volume": 0}]
    assert {(one.houses, one.episodes, one.path) for one in judged} == {(100, 7, AGENT_FILE)}
    table = capsys.readouterr().out
    assert table.count("0.625 ± 0.010") == 4
    assert [name for name in list_recipes() if f"\n{name} " not in f"\n{table}"] == []
    for name in ("rearrange", "objectnav-rgb", "dialogue"):
        assert f"{name:<24}not trained yet" in table
    assert "objectnav               not trained here: home-mjx train --recipe objectnav\n" in table
    Path("runs/audionav-unheard").mkdir(parents=True)
    assert main(["evaluate", "--recipe", "audionav-unheard", "--houses", "3"]) == 0
    assert judged[-1].path == Path("runs/audionav-unheard/checkpoint.npz")
    assert (judged[-1].houses, judged[-1].episodes) == (3, 1000)
    assert main(["evaluate"]) == 2
    assert "no CHECKPOINT" in capsys.readouterr().err


def test_results_are_machine_readable(judged, capsys: pytest.CaptureFixture):
    assert main(["evaluate", "demo", "--recipe", "pointnav-lidar", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["recipe"], found["expected"]) == ("pointnav-lidar", {"val": 0.959})
    assert found["results"]["val"]["trained"]["success"]["mean"] == 0.625


def test_the_card_of_an_agent_has_its_data_figures_and_limits():
    run = train.run_config(parse("--recipe", "audionav-unheard", "--houses=192", "--seconds=400"))
    figures = {"success": {"mean": 0.742, "stderr": 0.039}, "spl": {"mean": 0.529, "stderr": 0.034}}
    random = {"success": {"mean": 0.0, "stderr": 0.0}, "spl": {"mean": 0.0, "stderr": 0.0}}
    report = {"trained": figures, "random": random, "episodes": 128, "houses": 16, "split": "val", "device": "cpu"}
    card = format_card(run, report | {"actions": "sampled"})
    rows = dict(line[2:-2].split(" | ", 1) for line in card.splitlines() if re.match(r"\| (?!Card|---)", line))
    assert rows["Task"] == "AudioNav-v0, observing depth, log_mel, interaural, prev_action"
    assert rows["Data"] == "192 houses of procedural:1200, split train"
    assert "clip_split = training" in rows["Options"]
    assert rows["Training"].startswith(
        "8000000 steps of an expert's advice, then at most 40000000 steps of ppo, at most 400 s"
    )
    assert "success 0.742 ± 0.039 (random 0.000), spl 0.529 ± 0.034" in rows["Results"]
    assert "128 episodes in 16 houses of split val" in rows["Results"]
    assert "one seed" in rows["Limits"]
