"""Messages about what newcomers write first: unknown members, colours, names of houses, rows and options."""

import json
import logging
from dataclasses import dataclass

import numpy as np
import pytest

import home_mjx
from home_mjx.cli import main
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import ConfigError, DatasetError, MissingFileError, UnknownMemberError, UnknownNameError
from home_mjx.schema import Semantic
from home_mjx.schema.compiled import PortalKind
from home_mjx.schema.vocabulary import encode_name
from home_mjx.tasks import load_episodes, make_config, sample_episodes, save_episodes
from home_mjx.tasks.metrics.top_down import CellOccupancy
from home_mjx.tasks.rules import build_bank
from home_mjx.tasks.rules.enums import Attribute, Feature, Purpose, TargetKind
from home_mjx.tasks.sensors.proprioception import HELD_COLUMNS
from home_mjx.tasks.suite import HouseTasks, PointNav, RoomNav
from home_mjx.tasks.suite.navigation import NavigationTask


@pytest.mark.parametrize(
    ("enum", "wrong", "meant"),
    [
        (Semantic, "COLOUR", "COLOR"),
        (Semantic, "COARS", "COARSE"),
        (Semantic, "color", "COLOR"),
        (Semantic, "OBJECT", "OBJECT_ID"),
        (Attribute, "COLOURS", "COLOR"),
        (Feature, "DISTANCES", "DISTANCE"),
        (TargetKind, "ROOMS", "ROOM"),
        (Purpose, "TAKES", "TAKE"),
        (PortalKind, "DOORS", "DOOR"),
        (CellOccupancy, "FREEE", None),
    ],
)
def test_unknown_members_are_answered_with_the_closest(enum, wrong, meant):
    for read in (lambda: getattr(enum, wrong), lambda: enum[wrong]):
        with pytest.raises(UnknownMemberError, match=f"{enum.__name__} has no member `{wrong}`") as caught:
            read()
        assert meant is None or f"Did you mean `{meant}`?" in str(caught.value)
        assert isinstance(caught.value, AttributeError | KeyError)
    assert not hasattr(enum, wrong)
    assert getattr(enum, wrong, 7) == 7


def test_colour_has_one_name_in_tables_words_and_sensors():
    assert "color" in make_config(sensors=("color",)).sensors
    assert {Semantic.COLOR.name, Attribute.COLOR.name} == {"COLOR"}
    assert [Semantic.COLOR, Semantic.COLOR_2, Semantic.COLOR_3] == [11, 12, 13]
    assert "BASIC" not in Semantic.__members__
    assert Semantic.COLOR in HELD_COLUMNS
    for word in set(Attribute.__members__) & set(Semantic.__members__):
        assert word in ("FINE", "COARSE", "COLOR", "MATERIAL", "SIZE", "ROOM_TYPE", "ROOM", "OBJECT_ID")


@pytest.mark.parametrize(
    ("column", "name", "words"),
    [
        (
            Semantic.COLOR,
            "brown",
            "unknown color `brown`.*It is a name in `Semantic.CSS` and `Semantic.XKCD`.* is `maroon`",
        ),
        (Semantic.COLOR_2, "navy blue", "It is a name in `Semantic.XKCD`; .* is `navy`"),
        (Semantic.CSS, "redd", "Did you mean `red`"),
        (Semantic.MATERIAL, "woood", "unknown material `woood`.*Did you mean `wood`"),
    ],
)
def test_colours_of_other_palettes_are_told(column, name, words):
    with pytest.raises(UnknownNameError, match=words):
        encode_name(column, name)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("procedual:2", "Did you mean `procedural`"),
        ("Procedural:2?seed=4", "did you mean `procedural:2"),
        ("procedural2", "did you mean `procedural:2`"),
        ("procedural", "did you mean `procedural:N`"),
        ("proceduralll", "did you mean `procedural:N`"),
        ("procedural://2", "did you mean `procedural:2`"),
        ("procedural:2?version=2", "no option `version`.*preset=flat"),
        ("procedural:2?sead=3", "Did you mean `seed`"),
        ("procedural:2?preset=flats", "Did you mean `flat`"),
        ("procedural:2?detail=lo", "Did you mean `low`"),
        ("procedural:two", "does not name generated houses.*N and S are whole"),
        ("hssd:hm3d", "no dataset has the scheme `hssd:`"),
    ],
)
def test_names_of_generated_houses_are_not_taken_for_paths(name, words, capsys):
    with pytest.raises((ConfigError, MissingFileError), match=words):
        open_dataset(name)
    assert main(["inspect", "--dataset", name]) == 2
    assert "`" in capsys.readouterr().err


def test_a_missing_folder_is_still_a_missing_folder():
    for name in ("nowhere/houses", "houses_of_mine"):
        with pytest.raises(MissingFileError, match="Correct the path or SUNCG_DATA_DIR"):
            open_dataset(name)


@dataclass(frozen=True)
class Nothing(NavigationTask):
    """A generator that finds nothing in any house."""

    def rows(self, view, random):
        """None."""
        return iter(())


def test_a_generator_without_rows_is_named(generated_bank, caplog):
    with pytest.raises(ConfigError, match=r"Nothing yields no row in any of 2 houses. Check what `rows` looks for"):
        Nothing().task_bank(generated_bank)
    with pytest.raises(ConfigError, match=r"none of \d+ rows of RoomNav in 2 houses .* of 900 m to 1000.0 m"):
        RoomNav(min_length=900, num_tasks=2).task_bank(generated_bank)
    with caplog.at_level(logging.WARNING, build_bank.__name__):
        rows = HouseTasks(tasks=(RoomNav(), Nothing()), num_tasks=2).task_bank(generated_bank)
    assert set(np.asarray(rows.rows.columns["task"]).tolist()) == {0}
    assert "Nothing yields no row in any of 2 houses" in caplog.text


def test_a_goal_that_the_bank_lacks_points_to_rows(generated_bank, tmp_path):
    path = tmp_path / "e.jsonl"
    save_episodes(path, generated_bank, sample_episodes(generated_bank, 1))
    line = json.loads(path.read_text())
    path.write_text(json.dumps(line | {"goal": [line["goal"][0] + 0.03, *line["goal"][1:]]}) + "\n")
    with pytest.raises(DatasetError, match=r"no goal at .* is 0.03 m away.*any place of the floor: docs/own_task.md"):
        load_episodes(path, generated_bank)


def test_an_environment_without_observations_is_refused(generated_bank):
    with pytest.raises(ConfigError, match=r"`sensors` is empty, .* Name some"):
        home_mjx.make("PointNav-v0", generated_bank, sensors=())


def test_one_name_for_the_distance_of_success():
    assert PointNav(success_distance=0.2).success_distance == 0.2
    for task in home_mjx.list_envs():
        with pytest.raises(ConfigError, match="`success_distance`"):
            home_mjx.make(task, success_radius=0.2)
