"""The search of the demo: which agent, which sounds, and that the agent has never heard such."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.env_factory import make_core
from home_mjx.tasks.env.observers import EpisodeStep
from home_mjx.tasks.suite.audio_nav import SPLITS
from home_mjx.training import load_policy, read_config
from home_mjx.viewer.demo.search import AGENT_FILE, ClipNames, search_spec

MAX_BYTES = 5e6


def test_the_agent_in_the_box_searches_for_kinds_of_sounds_that_it_has_not_heard():
    """Its own sensors and sound options go with it, its network fits, and the file is small."""
    trained = read_config(AGENT_FILE).env
    spec = search_spec(trained, episodes=2)
    kinds = {name.rpartition("_")[0] or name for name in SPLITS[trained.options["clip_split"]]}
    sought = SPLITS[spec.options["clip_split"]]
    assert len(sought) == 2
    assert not {name.rpartition("_")[0] for name in sought} & kinds
    assert set(sought) <= set(SPLITS["held_out"])
    assert spec.options["sensors"] == trained.options["sensors"] == ("depth", "log_mel", "interaural", "prev_action")
    assert (spec.split, spec.num_houses, spec.options["variation"]) == ("val", 2, None)
    load_policy(AGENT_FILE, make_core(spec))
    assert AGENT_FILE.stat().st_size <= MAX_BYTES


def test_the_demo_says_which_clips_it_played():
    clips = ClipNames()
    for index, name in ((0, "talking_0"), (1, "whistling_0"), (0, "whistling_0")):
        sounds = SimpleNamespace(clip=np.array([CLIPS.index(name)]))
        clips.on_episode_step(EpisodeStep(index, SimpleNamespace(world=SimpleNamespace(sounds=sounds)), None, 0.0))
    assert clips.names == ["talking_0", "whistling_0"]
