"""PPO while houses vary and a curriculum goes on: one program, and only rows that have a weight."""

import jax
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.tasks import HouseholdEnv, Variation, make_config
from home_mjx.tasks.suite import PointGoals
from home_mjx.training import PPO, NetworkConfig, PPOConfig

SMALL = PPOConfig(
    num_envs=8,
    num_timesteps=8 * 8 * 10,
    unroll_length=8,
    num_minibatches=2,
    num_epochs=1,
    optimizer="adam",
    network=NetworkConfig(features=16, memory=16, channels=(4, 8)),
)
RANGES = {"exposure": (0.5, 2.0), "colors": (0.0, 0.3), "camera_height": (-0.2, 0.2), "color_noise": (0.0, 1.0)}


@pytest.mark.slow
def test_updates_go_on_while_weights_and_ranges_change(generated_bank):
    options = {"sensors": ("rgb", "goal"), "width": 8, "height": 8, "impl": "kinematic", "episode_length": 3}
    core = HouseholdEnv(make_config(actions="discrete", **options), PointGoals(num_tasks=16, num_points=2))
    env = core.bind(generated_bank).with_variation(RANGES)
    ppo, tasks = PPO(core, SMALL, jax.devices()[:1]), env.params.tasks
    length = np.asarray(tasks.rows.columns["length"])
    middle = float(np.median(length))
    easy = env.params.replace(tasks=tasks.with_weights(length <= middle))
    variation = Variation.of(**RANGES | {"exposure": (3, 4)})
    hard = easy.replace(tasks=tasks.with_weights(length > middle), variation=variation)
    state, programs = ppo.init(easy, jax.random.key(0)), []
    for params, is_wanted in ((easy, length <= middle), (hard, length > middle)):
        for _ in range(2):
            state, metrics = ppo.update(params, state)
        programs.append(ppo.update._cache_size())
        assert all(np.isfinite(x) for x in metrics.values())
        assert is_wanted[np.asarray(state.actor.env.world.episode)].all()
    assert state.actor.env.world.variation.appearance.exposure.min() >= 3
    assert programs[0] == programs[1]  # no other than those of a first and a later update
