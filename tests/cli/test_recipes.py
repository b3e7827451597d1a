"""Recipes: each is a valid training; what a user changes counts and is said; broken ones are refused."""

from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.cli import main
from home_mjx.cli.learning import train
from home_mjx.cli.learning.recipes import changed_options, list_recipes, read_recipe
from home_mjx.cli.parsing import Parser
from home_mjx.env_factory import make_core
from home_mjx.training.ppo import PPO


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
    assert list(changed_options(args, recipe, train.add_arguments)) == []


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


def test_all_evaluations_of_a_recipe_are_printed(monkeypatch, tmp_path: Path, capsys: pytest.CaptureFixture):
    """Each with its own options; `all` takes the recipes that have been trained."""
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", "--recipe", "all"]) == 2
    assert "no recipe has been trained" in capsys.readouterr().err
    (tmp_path / "runs" / "audionav-unheard").mkdir(parents=True)
    given = []

    def judge(path, split, houses, episodes, *more, dataset, options):
        given.append(SimpleNamespace(path=path, houses=houses, episodes=episodes, options=options))
        figures = {"success": {"mean": 0.625, "stderr": 0.01}, "spl": {"mean": 0.5, "stderr": 0.01}}
        return {"trained": figures, "random": {"success": {"mean": 0.0, "stderr": 0.0}}}

    monkeypatch.setattr("home_mjx.training.evaluate_checkpoint", judge)
    assert main(["evaluate", "--recipe", "all", "--episodes", "7"]) == 0
    assert [one.options["clip_split"] for one in given] == ["held_out", "unheard", "training", "held_out"]
    assert [one.options["variation"] for one in given] == [None, None, None, {"volume": 0}]
    assert {(one.houses, one.episodes, one.path.parent.name) for one in given} == {(100, 7, "audionav-unheard")}
    assert capsys.readouterr().out.count("0.625 ± 0.010") == 4
    assert main(["evaluate"]) == 2
    assert "no CHECKPOINT" in capsys.readouterr().err
