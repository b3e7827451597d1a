"""Checkpoints: whole or not there, and of the same configuration."""

import dataclasses
import io
import json
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.cli import main
from home_mjx.core.jsonable import to_json
from home_mjx.errors import ConfigError, DatasetError, MissingFileError
from home_mjx.registry import EnvSpec
from home_mjx.tasks import DiscreteActions
from home_mjx.training import checkpoint
from home_mjx.training.checkpoint import load_checkpoint, load_net, read_config, save_checkpoint, save_net
from home_mjx.training.config import CPU_CONFIG, PPOConfig, RunConfig

OPTIONS = {"sensors": ("state", "goal"), "actions": DiscreteActions(turn_angle=30.0), "ctrl_dt": 0.4}
CONFIG = RunConfig(EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav", OPTIONS, num_houses=2), CPU_CONFIG, 3)


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
        "`env.options.sensors.1` is goal there, None here": dataclasses.replace(
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
    for path, words in ((broken, "not a valid checkpoint"), (other, "lacks config"), (older, r"lacks \.rest")):
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


def test_results_of_episodes_are_no_checkpoint(tmp_path: Path, capsys: pytest.CaptureFixture):
    path = tmp_path / "result.jsonl"
    path.write_text('{"number": 1, "task": "PointNav"}\n')
    assert main(["evaluate", str(path)]) == 2
    told = capsys.readouterr().err
    assert "not a valid checkpoint, but JSON lines" in told
    assert "Pass the folder of a `home-mjx train` run" in told
    assert "pickle" not in told


def test_an_empty_file_and_a_bare_array_are_no_checkpoints(tmp_path: Path):
    (tmp_path / "empty.npz").write_bytes(b"")
    with (tmp_path / "array.npz").open("wb") as file:
        np.save(file, np.zeros(3))
    for name in ("empty.npz", "array.npz"):
        with pytest.raises(DatasetError, match="not a valid checkpoint"):
            read_config(tmp_path / name)


HEADER = "{'descr': %s, 'fortran_order': False, 'shape': %s, }"
MADE_UP = {
    "too large": HEADER % ("'<f4'", "(1000000000000,)"),
    "huge": HEADER % ("'<f4'", "(1000000, 1000000, 1000000)"),
    "beyond numbers": HEADER % ("'<f4'", "(99999999999999999999999,)"),
    "no end": HEADER[:-3] % ("'<f4'", "(4, 4"),
    "brackets": "(" * 3000,
    "signs": "-" * 3000 + "1",
    "a list as name": "{[]: 1}",
    "objects": HEADER % ("'|O'", "(4, 4)"),
    "wide": HEADER % ("'V99999999999'", "(4, 4)"),
}


@pytest.mark.parametrize("header", MADE_UP.values(), ids=MADE_UP)
def test_made_up_arrays_are_no_checkpoint(tmp_path: Path, header: str):
    """NumPy meets them with MemoryError, OverflowError, RecursionError, TokenError, TypeError."""
    path, config = tmp_path / "made_up.npz", io.BytesIO()
    np.save(config, np.array(to_json(CONFIG)))
    text = header.encode().ljust(-(-(len(header) + 11) // 64) * 64 - 11) + b"\n"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("config.npy", config.getvalue())
        file.writestr(".net['w'].npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text)
    assert read_config(path) == CONFIG
    with pytest.raises(DatasetError, match="not a valid checkpoint"):
        load_net(path, {"w": jnp.zeros((4, 4))})


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_network_that_is_not_finite_is_refused(tmp_path: Path, bad: float):
    path = tmp_path / "agent.npz"
    save_net(path, {"dense": jnp.array([1.0, bad])}, CONFIG)
    with pytest.raises(DatasetError, match=r"not finite \(.*\['dense'\].*learning_rate"):
        load_net(path, {"dense": jnp.zeros(2)})
    save_checkpoint(path, Tree({"dense": jnp.array([1.0, bad])}, [jnp.inf]), CONFIG)
    with pytest.raises(DatasetError, match="not finite"):
        load_checkpoint(path, Tree({"dense": jnp.zeros(2)}, [jnp.float32(0)]), CONFIG)
    save_checkpoint(path, Tree({"dense": jnp.ones(2)}, [jnp.float32(bad)]), CONFIG)  # such as depth that misses
    load_checkpoint(path, Tree({"dense": jnp.zeros(2)}, [jnp.float32(0)]), CONFIG)


ODD = (
    ("env.options", 5),
    ("env.entry_point", 5),
    ("env.num_houses", "x"),
    ("env.num_houses", 10**400),
    ("env.split", 5),
    ("env.where", 5),
    ("env.houses", 5),
    ("env.in_memory", 1),
    ("env.id", 5),
    ("env.__type__", 5),
    ("env.__type__", []),
    ("env.options.sensors", {"__tuple__": 5}),
    ("start", 5),
    ("seed", 10**400),
    ("max_seconds", 0),
    ("new", 1),
)
READ = """
import sys
from home_mjx.errors import ConfigError
from home_mjx.training import read_config

for path in sys.argv[1:]:
    try:
        print(path, "is read as", read_config(path))
    except ConfigError as error:
        assert path in str(error), error
"""


def test_configurations_of_odd_values_are_refused_with_their_file(tmp_path: Path):
    """In a process of its own: here, beartype refuses odd types before we do."""
    paths = []
    for place, value in ODD:
        part = config = json.loads(to_json(CONFIG))
        *way, last = place.split(".")
        for name in way:
            part = part[name]
        part[last] = value
        paths.append(tmp_path / f"{len(paths)}-{place}.npz")
        np.savez(paths[-1], config=np.array(json.dumps(config)))
    done = subprocess.run([sys.executable, "-c", READ, *paths], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


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
