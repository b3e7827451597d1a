"""Checkpoints: whole or not there, and of the same configuration."""

import dataclasses
import sys
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.errors import ConfigError, DatasetError, MissingFileError
from home_mjx.registry import EnvSpec
from home_mjx.tasks import DiscreteActions
from home_mjx.training import checkpoint
from home_mjx.training.checkpoint import load_checkpoint, load_net, read_config, save_checkpoint, save_net
from home_mjx.training.config import CPU_CONFIG, PPOConfig, RunConfig

OPTIONS = {"sensors": ("state", "goal"), "actions": DiscreteActions(turn_angle=30.0), "ctrl_dt": 0.4}
CONFIG = RunConfig(EnvSpec("PointNav-v0", "home_mjx.tasks:PointNav", OPTIONS, num_houses=2), CPU_CONFIG, 3)


@dataclasses.dataclass
class Tree:
    net: dict
    rest: list


jax.tree_util.register_dataclass(Tree, ["net", "rest"], [])


def tree(value: float = 1.5) -> Tree:
    return Tree(
        {"dense": jnp.full((2, 3), value), "bias": jnp.float32(value)},
        [jnp.arange(4, dtype=jnp.uint32), jnp.zeros((0, 2)), jnp.array([True, False])],
    )


def equal(a: object, b: object) -> bool:
    same = jax.tree.map(lambda x, y: np.array_equal(x, y) and x.dtype == y.dtype, a, b)
    return jax.tree.all(same)


def test_everything_comes_back(tmp_path: Path):
    path = tmp_path / "checkpoint.npz"
    save_checkpoint(path, tree(), CONFIG)
    assert equal(load_checkpoint(path, tree(0.0), CONFIG), tree())
    assert equal(load_net(path, tree(0.0).net), tree().net)
    assert read_config(path) == CONFIG
    assert [file.name for file in tmp_path.iterdir()] == ["checkpoint.npz"]


def test_a_network_alone_is_small_and_begins_a_run(tmp_path: Path):
    """In half precision: what is read is what was written, rounded to 11 bits."""
    whole, alone = tmp_path / "whole.npz", tmp_path / "agent.npz"
    net = {"dense": jnp.linspace(-2.0, 3.0, 30_000).reshape(100, 300)}
    save_checkpoint(whole, Tree(net, [net["dense"]]), CONFIG)
    save_net(alone, net, CONFIG)
    assert alone.stat().st_size < whole.stat().st_size / 3.5
    assert read_config(alone) == CONFIG
    found = load_net(alone, net)
    assert found["dense"].dtype == np.float32
    np.testing.assert_array_equal(found["dense"], np.asarray(net["dense"]).astype(np.float16))
    with pytest.raises(DatasetError, match=r"lacks \.rest"):
        load_checkpoint(alone, Tree(net, [jnp.zeros(1)]), CONFIG)


def test_a_write_that_breaks_off_leaves_the_old_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "checkpoint.npz"
    save_checkpoint(path, tree(), CONFIG)

    def killed(file: object, **arrays: object) -> None:
        file.write(b"half")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(checkpoint.np, "savez", killed)
        with pytest.raises(KeyboardInterrupt):
            save_checkpoint(path, tree(2.0), CONFIG)
    assert equal(load_checkpoint(path, tree(), CONFIG), tree())
    save_checkpoint(path, tree(2.0), CONFIG)
    assert equal(load_checkpoint(path, tree(), CONFIG), tree(2.0))
    assert [file.name for file in tmp_path.iterdir()] == ["checkpoint.npz"]


def with_ppo(**options: object) -> RunConfig:
    return dataclasses.replace(CONFIG, ppo=dataclasses.replace(CPU_CONFIG, **options))


def test_another_configuration_is_refused_by_name(tmp_path: Path):
    path = tmp_path / "checkpoint.npz"
    save_checkpoint(path, tree(), CONFIG)
    network = dataclasses.replace(CPU_CONFIG.network, memory=64)
    others = {
        "`ppo.num_envs` is 64 there, 32 here": with_ppo(num_envs=32),
        "`ppo.network.memory` is 128 there, 64 here": with_ppo(network=network),
        "`seed` is 3 there, 4 here": dataclasses.replace(CONFIG, seed=4),
        "`env.num_houses` is 2 there, 8 here": dataclasses.replace(
            CONFIG, env=dataclasses.replace(CONFIG.env, num_houses=8)
        ),
        "`env.options.sensors.__tuple__.1` is goal there, None here": dataclasses.replace(
            CONFIG, env=dataclasses.replace(CONFIG.env, options=OPTIONS | {"sensors": ("state",)})
        ),
    }
    for words, other in others.items():
        with pytest.raises(ConfigError) as error:
            load_checkpoint(path, tree(), other)
        assert words in str(error.value)
        assert str(error.value).count(" there, ") == 1


def test_files_that_are_no_checkpoint(tmp_path: Path):
    with pytest.raises(MissingFileError):
        read_config(tmp_path / "none.npz")
    broken, other, older = (tmp_path / name for name in ("broken.npz", "other.npz", "older.npz"))
    broken.write_bytes(b"PK\x03\x04 and no more")
    np.savez(other, x=np.zeros(3))
    save_checkpoint(older, Tree(tree().net, []), CONFIG)
    for path, words in ((broken, "no checkpoint"), (other, "lacks config"), (older, r"lacks \.rest")):
        with pytest.raises(DatasetError, match=words):
            load_checkpoint(path, tree(), CONFIG)


def test_a_file_does_not_choose_what_is_run(tmp_path: Path):
    """A checkpoint could name any function of any module as its environment, and it was called with its options."""
    harm = tmp_path / "harm"
    env = EnvSpec("PointNav-v0", "timeit:timeit", {"setup": f"open({str(harm)!r}, 'w')", "number": 0})
    save_net(tmp_path / "evil.npz", tree().net, dataclasses.replace(CONFIG, env=env))
    with pytest.raises(ConfigError, match="no environment `PointNav-v0` of `timeit:timeit` is registered"):
        read_config(tmp_path / "evil.npz")
    text = CONFIG.env.to_json().replace("home_mjx.registry:EnvSpec", "antigravity:EnvSpec")
    with pytest.raises(ConfigError, match="has not been imported"):
        EnvSpec.from_json(text)
    assert not harm.exists()
    assert "antigravity" not in sys.modules


def test_an_empty_file_and_a_bare_array_are_no_checkpoints(tmp_path: Path):
    (tmp_path / "empty.npz").write_bytes(b"")
    with (tmp_path / "array.npz").open("wb") as file:
        np.save(file, np.zeros(3))
    for name in ("empty.npz", "array.npz"):
        with pytest.raises(DatasetError, match="no checkpoint"):
            read_config(tmp_path / name)


def test_other_shapes_are_refused(tmp_path: Path):
    path = tmp_path / "checkpoint.npz"
    save_checkpoint(path, tree(), CONFIG)
    wider = Tree({"dense": jnp.zeros((2, 4)), "bias": jnp.float32(0)}, tree().rest)
    with pytest.raises(DatasetError, match=r"expected float32 \(2, 4\), got float32 \(2, 3\)"):
        load_checkpoint(path, wider, CONFIG)


@pytest.mark.parametrize(
    "option",
    [
        {"num_envs": 0},
        {"discount": 1.5},
        {"learning_rate": -1.0},
        {"optimizer": "sgd"},
        {"final_obs": "none"},
        {"clip_range": float("nan")},
    ],
)
def test_unusable_options_are_refused(option: dict):
    with pytest.raises(ConfigError, match=next(iter(option))):
        PPOConfig(**option)


def test_numbers_that_do_not_divide_are_refused():
    with pytest.raises(ConfigError, match="multiple of the 3 devices"):
        PPOConfig(num_envs=64).check_devices(3)
    with pytest.raises(ConfigError, match="must divide 32, got 5"):
        PPOConfig(num_envs=64, num_minibatches=5).check_devices(2)
    PPOConfig(num_envs=64, num_minibatches=64).check_devices(2, num_agents=2)
