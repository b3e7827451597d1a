"""Sessions without a page: several environments, checkpoints that change, and what the curves get."""

import os
from pathlib import Path

import jax
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from handmade import Furniture, shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import HomeMjxError
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.observers import ObserverGroup
from home_mjx.training import save_net
from home_mjx.training.config import PPOConfig, RunConfig
from home_mjx.training.networks.agent import NetworkConfig
from home_mjx.training.ppo import PPO
from home_mjx.viewer.browser.checkpoints import NEWEST, Checkpoints
from home_mjx.viewer.browser.session import Session
from home_mjx.viewer.episodes.held_keys import HeldKeys

CONFIG = PPOConfig(network=NetworkConfig(features=8, memory=8))
NUM_ENVS = 3


@pytest.fixture(scope="module")
def env():
    bank = HouseBank.from_compiled([shoebox(furniture=(Furniture((1.0, 0.0)),))])
    return home_mjx.make("PointNav-v0", bank, sensors=("state", "goal"), impl="kinematic", episode_length=50)


def write_net(env, path: Path, seed: int, when: int) -> None:
    net = PPO(env.core, CONFIG, jax.devices()[:1]).agent.init_net(jax.random.key(seed))
    save_net(path, net, RunConfig(EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav"), CONFIG, 1))
    os.utime(path, ns=(when, when))


@pytest.fixture(scope="module")
def folder(env, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    write_net(env, folder / "old.npz", 0, 10**18)
    write_net(env, folder / "checkpoint.npz", 1, 2 * 10**18)
    return folder


@pytest.fixture(scope="module")
def session(env, folder) -> Session:
    errors = []
    session = Session(env, "trained", ObserverGroup(()), (HeldKeys(),), folder, 0, errors.append, NUM_ENVS)
    session.errors = errors
    return session


def bias(session: Session) -> float:
    return float(sum(np.abs(np.asarray(x, np.float64)).sum() for x in jax.tree.leaves(session._players[0].net)))


def test_all_environments_step_and_the_watched_one_changes(session: Session):
    for _ in range(5):
        session.advance()
    assert [episode.step.index for episode in session.episodes] == [5] * NUM_ENVS
    places = [np.asarray(episode.step.state.physics.qpos) for episode in session.episodes]
    assert not np.array_equal(places[0], places[1])
    session.watch(2)
    assert np.array_equal(session.episode.step.state.physics.qpos, places[2])
    session.advance()
    assert session.episode.step.index == 6
    session.watch(99)
    assert session.watched == NUM_ENVS - 1
    assert np.isfinite(session.value)


def test_the_newest_checkpoint_is_loaded_at_the_next_episode(env, folder: Path, session: Session):
    assert session.checkpoints.names() == (NEWEST, "checkpoint.npz", "old.npz")
    assert session.checkpoints.describe() == "checkpoint.npz"
    before, program = bias(session), session._players[0]._act
    write_net(env, folder / "later.npz", 2, 3 * 10**18)
    for _ in range(3):
        session.advance()
    assert bias(session) == before
    assert not session._players[session.watched].is_first
    session.reset()
    assert session.checkpoints.describe() == "later.npz"
    assert bias(session) != before
    assert session._players[session.watched].is_first  # the memory begins anew
    assert session._players[0]._act is program
    session.choose_checkpoint("old.npz")
    assert [episode.step.index for episode in session.episodes] == [0] * NUM_ENVS
    assert session.checkpoints.name == "old.npz"


def test_a_checkpoint_that_cannot_be_loaded_changes_nothing(folder: Path, session: Session):
    before, name = bias(session), session.checkpoints.name
    (folder / "broken.npz").write_bytes(b"PK")
    with pytest.raises(HomeMjxError):
        session.choose_checkpoint("broken.npz")
    assert (bias(session), session.checkpoints.name) == (before, name)
    (folder / "old.npz").write_bytes(b"PK")
    session.reset()
    assert bias(session) == before
    assert len(session.errors) == 1


def test_a_folder_without_checkpoints_is_named(tmp_path: Path):
    with pytest.raises(HomeMjxError, match="no checkpoint"):
        Checkpoints(tmp_path).load_path()
