"""Two agents play the story by actions alone, and it is filmed."""

from pathlib import Path

import numpy as np
import pytest

from examples.story import play
from examples.story.film import Film
from examples.story.house import write_story_house
from examples.story.places import Places
from examples.story.script import CARRIER, WATCHER, Script, Stage
from home_mjx.errors import HomeMjxError
from home_mjx.tasks.base.status import Status

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def env(tmp_path_factory: pytest.TempPathFactory):
    root = tmp_path_factory.mktemp("story")
    write_story_house(root)
    return play.make_story_env(root, sensors=("rgb", "audio"), width=16, height=12)


@pytest.fixture(scope="module")
def film(env):
    return Film(env, Places.of(env.bank).lamp.body)


@pytest.fixture(scope="module")
def story(env, film):
    steps = []

    def told(step):
        steps.append(step)
        film.told(step)

    play.play(env, told)
    return steps


@pytest.fixture(scope="module")
def script(env):
    return Script(env.config, Places.of(env.bank))


def test_it_begins_downstairs_before_a_closed_door(env, story, script):
    first = story[0].moment
    assert first.door_angle[0] == pytest.approx(float(env.bank.physics.door_closed[0, 0]), abs=1e-3)
    assert first.pos[CARRIER, 2] < 1 < first.pos[WATCHER, 2]
    assert first.held.tolist() == [-1, -1]
    assert not script.stands(first)


def test_it_ends_as_it_should(env, story, script):
    """The door is open, the agent upstairs, its hand empty, and the lamp stands on the table, upright and at rest."""
    last = story[-1].moment
    assert abs(last.door_angle[0] - float(env.bank.physics.door_fully_open[0, 0])) < 0.15
    assert script.is_upstairs(last)
    assert last.held.tolist() == [-1, -1]
    assert script.stands(last)


def test_nothing_is_moved_but_by_the_agents(story):
    """In a step of 0.1 s nobody goes farther than he can walk, and the lamp is moved only by a hand."""
    pos = np.stack([step.moment.pos for step in story])
    assert np.linalg.norm(np.diff(pos[..., :2], axis=0), axis=-1).max() < 0.12
    assert abs(np.diff(pos[..., 2], axis=0)).max() < 0.12
    lost = {flag for step in story for flag in Status if int(step.state.status) & flag}
    assert lost <= {Status.RESPONSE_CUT}  # a hall of two storeys rings longer than responses are


def test_the_lamp_goes_the_whole_way_in_the_hand(story, script):
    lamp = script.places.lamp.body
    carried = [step.moment for step in story if step.moment.held[CARRIER] == lamp]
    apart = [np.linalg.norm(m.body_pos[lamp, :2] - m.pos[CARRIER, :2]) for m in carried]
    assert len(carried) > 20
    assert max(apart) < 0.9
    free = np.stack([s.moment.body_pos[lamp] for s in story if s.moment.held[CARRIER] != lamp and s is not story[-1]])
    assert np.linalg.norm(np.diff(free, axis=0), axis=-1).max() > 2  # from the sideboard to the table, by hand alone
    assert np.sort(np.linalg.norm(np.diff(free, axis=0), axis=-1))[-2] < 0.05


def test_the_watcher_follows_with_its_eyes(story, script):
    """Once it is at its place it has the carrier in view, at most 0.2 rad from the middle, in nine steps of ten."""
    there = [s.moment for s in story if script.watcher.distance(s.moment, script.places.lookout) < 0.15]
    assert len(there) > 0.8 * len(story)
    off = [max(map(abs, script.watcher._off(m, m.pos[CARRIER]))) for m in there[20:]]
    assert np.mean(np.array(off) < 0.2) > 0.9


def test_the_film_has_sound_and_every_stage(film, story, tmp_path: Path):
    film.write(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"story.mp4", "story.wav", "story.png"}
    assert len(film.shots) == len(story)
    assert len({shot.caption for shot in film.shots}) == 10
    assert np.abs(film.shots[0].sound).max() > 0


def test_a_stage_that_takes_too_long_says_so(env, monkeypatch):
    never = Stage("waits for ever", lambda m: np.zeros(7, np.float32), lambda m: False, limit=0.3)
    monkeypatch.setattr(Script, "stages", lambda self: iter([never]))
    with pytest.raises(HomeMjxError, match=r"after 0.3 s .* `waits for ever`: it is at .*holds nothing"):
        play.play(env)
