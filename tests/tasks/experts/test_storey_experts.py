"""The expert of PointNav reaches goals on its own storey, upstairs and downstairs, over stairs of every kind."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from parted import parted
from storey_homes import HOMES, homes_bank

import home_mjx
from home_mjx.tasks import add_expert, sample_episodes

MOST_STEPS = 400
FEW = ("corner", "curve", "above one another")


def play(impl: str, per_kind: int, names: tuple[str, ...] = tuple(HOMES)) -> dict[tuple[str, int], float]:
    """Success by home, and by whether the goal is below (-1), on (0) or above (1) the storey of the start."""
    bank = homes_bank(names)
    drawn = sample_episodes(bank, 100 * len(names), min_length=4.0)
    house, start = np.asarray(drawn.house), np.asarray(drawn.start)
    goal = np.asarray(bank.navigation.goal)[house, np.asarray(drawn.columns["goal"])]
    kind = np.sign(np.round((goal[:, 2] - start[:, 2]) / 2)).astype(int)
    kinds = [(h, k) for h in range(len(names)) for k in (-1, 0, 1)]
    rows = np.concatenate([np.flatnonzero((house == h) & (kind == k))[:per_kind] for h, k in kinds])
    env = home_mjx.make(
        "PointNav-v0", bank, impl=impl, actions="discrete", stop=True, success_distance=0.2, sensors=("state",),
        episode_length=MOST_STEPS,
    )  # fmt: skip
    core, params = (env := add_expert(env.with_tasks(drawn.pick(jnp.asarray(rows))))).core, env.params
    reset, step = parted(core, batched=True)
    states = reset(params, jax.random.split(jax.random.key(0), len(rows)), None, jnp.arange(len(rows)))
    over, good = np.zeros(len(rows), bool), np.zeros(len(rows))
    for _ in range(MOST_STEPS):
        states = step(params, states, states.obs["expert"])
        ended = np.asarray(states.done) & ~over
        good[ended], over = np.asarray(states.metrics["success"])[ended], over | ended
        if over.all():
            break
    return {
        (names[h], k): float(good[own].mean())
        for h, k in kinds
        if (own := (house[rows] == h) & (kind[rows] == k)).any()
    }


def test_kinematic_agents_arrive_on_every_storey():
    success = play("kinematic", 2, FEW)
    assert len(success) == 3 * len(FEW)
    assert {key: share for key, share in success.items() if share < 1} == {}


@pytest.mark.slow
@pytest.mark.parametrize("impl", ["kinematic", "fused"])
def test_agents_arrive_on_every_storey(impl):
    assert {key: share for key, share in play(impl, 10).items() if share < 1} == {}
