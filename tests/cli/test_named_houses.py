"""Every command takes the name of generated houses, and sensors where it has some."""

import json
from pathlib import Path

import numpy as np
import pytest
from generated import flat_id
from PIL import Image

from home_mjx.cli import main
from home_mjx.cli.commands import demo
from home_mjx.cli.learning import play, record, train

NAME = "procedural:2?seed=7310&preset=flat"


@pytest.fixture
def specs(monkeypatch: pytest.MonkeyPatch) -> list:
    """The specs that commands would make an environment of."""
    found = []

    def note(spec, *_, **__):
        found.append(spec if hasattr(spec, "houses") else spec.env)
        raise KeyboardInterrupt

    monkeypatch.setattr("home_mjx.viewer.episodes.run.run_play", note)
    monkeypatch.setattr("home_mjx.env_factory.make", note)
    return found


@pytest.mark.parametrize("place", ["HOUSE", pytest.param("--dataset", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "command",
    [["inspect", "--json"], ["inspect", "--semantics"], ["inspect", "--validate"], ["compile", "--mjcf", "OUT"]],
    ids=" ".join,
)
def test_commands_of_houses_take_a_name(command: list[str], place: str, tmp_path: Path, capsys: pytest.CaptureFixture):
    named = [NAME] if place == "HOUSE" else ["--dataset", NAME]
    assert main([command[0], *named, *(str(tmp_path) if word == "OUT" else word for word in command[1:])]) == 0
    out = capsys.readouterr().out
    if command == ["inspect", "--json"] and place == "HOUSE":
        assert json.loads(out)["counts"]["houses"] == 2  # of the whole name, as of a folder
    elif command[0] == "inspect":
        assert flat_id(7310) in out or "objects outside" in out
    else:
        assert any(Path(line).is_file() for line in out.splitlines())


@pytest.mark.parametrize("named", [[NAME], ["--dataset", NAME], [flat_id(7311), "--dataset", NAME]], ids=len)
def test_render_takes_a_name_and_writes_the_kinds_that_it_is_asked_for(
    named: list[str], tmp_path: Path, capsys: pytest.CaptureFixture
):
    size = ["--size", "16", "12", "--out", str(tmp_path)]
    assert main(["render", *named, "--sensors", "depth, instance,depth", *size]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["depth.png", "instance.png"]
    with Image.open(tmp_path / "depth.png") as image:
        assert np.asarray(image).std() > 5
    assert capsys.readouterr().out.count("\n") == 2


def test_the_folder_of_a_dataset_is_still_no_house(tmp_path: Path, capsys: pytest.CaptureFixture):
    (tmp_path / "houses").mkdir()
    assert main(["render", str(tmp_path / "houses"), "--out", str(tmp_path / "out")]) == 2
    assert "Pass one of its houses" in capsys.readouterr().err


def test_play_takes_a_name_and_then_all_its_houses(specs: list):
    for more in ([], ["--split", "train"]):
        with pytest.raises(KeyboardInterrupt):
            play.run(parsed(play, ["PointNav", "--no-film", "--dataset", NAME, *more]))
    assert [(spec.houses, spec.split) for spec in specs] == [(NAME, None), (NAME, "train")]


@pytest.mark.parametrize(
    ("more", "sensors"),
    [
        (["AudioNav"], ("state", "audio")),
        (["PiedPiper"], ("state", "audio")),
        (["AudioNav", "--no-film"], ("state",)),
        (["AudioNav", "--sensors", "depth"], ("depth",)),
        (["AudioNav", "--env", 'sensors=["rgb"]'], ["rgb"]),
        (["PointNav"], ("state",)),
        (["PointNav", "--sensors", "audio, state"], ("audio", "state")),
    ],
    ids=lambda value: " ".join(value),
)
def test_films_of_tasks_with_sounds_have_sound(
    specs: list, more: list[str], sensors: tuple, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """`play AudioNav` made a silent film."""
    with pytest.raises(KeyboardInterrupt):
        play.run(parsed(play, [*more, "--out", str(tmp_path / "play")]))
    assert specs[0].options["sensors"] == sensors


def test_record_and_train_take_names_and_sensors(specs: list, tmp_path: Path):
    with pytest.raises(KeyboardInterrupt):
        record.run(parsed(record, ["PointNav", "--dataset", NAME, "--sensors", "depth,goal", "--out", str(tmp_path)]))
    assert (specs[0].houses, specs[0].options["sensors"]) == (NAME, ("depth", "goal"))
    spec = train.env_spec(parsed(train, ["PointNav", "--dataset", NAME, "--sensors", "depth,goal"]))
    assert (spec.houses, spec.options["sensors"]) == (NAME, ("depth", "goal"))
    assert train.env_spec(parsed(train, ["PointNav"])).options["sensors"] == ("state", "goal")


def test_demo_and_evaluate_take_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    given = []
    monkeypatch.setattr("home_mjx.viewer.demo.run.run_demo", lambda options: given.append(options.suncg) or 1 / 0)
    with pytest.raises(ZeroDivisionError):
        demo.run(parsed(demo, ["--dataset", NAME, "--out", str(tmp_path)]))
    monkeypatch.setattr(
        "home_mjx.training.evaluate_checkpoint", lambda *_, **more: given.append(more["dataset"]) or 1 / 0
    )
    with pytest.raises(ZeroDivisionError):
        main(["evaluate", "demo", "--dataset", NAME])
    assert given == [NAME, NAME]


def parsed(module, arguments: list[str]):
    from home_mjx.cli.parsing import Parser

    parser = Parser(prog="home-mjx")
    module.add_arguments(parser)
    return parser.parse_args(arguments)
