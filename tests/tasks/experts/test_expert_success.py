"""Experts succeed: in whole episodes of every task as it is registered, in houses that nothing was tuned on."""

import pytest
from generated import generate_flats

import home_mjx
from home_mjx.houses import load_bank
from home_mjx.tasks import add_expert
from home_mjx.training.evaluation import evaluate, expert_policy

LEAST = 0.99  # share of episodes that succeed
EPISODES = 24
HOUSES = range(61_000, 61_004)
CASES = {
    "PointNav-v0": {},
    "PointNav-v0 as Habitat has it": {"actions": "discrete", "stop": True, "success_distance": 0.2},
    "RoomNav-v0": {},
    "ObjectNav-v0": {},
    "InstructionFollowing-v0": {},
    "AudioNav-v0": {},
    "AudioNav-v0 of what moves": {"moving_source": True},
    "Exploration-v0": {},
    "PiedPiper-v0": {},
    "HouseQA-v0": {},
    "VQA-v0": {},
    "Dialogue-v0": {},
    "Communication-v0": {},
    "Fetch-v0": {},
    "Rearrange-v0": {},
    "Toggle-v0": {},
    "RoomNav-v0 by numbers": {"actions": "continuous", "stop": False},
    "ObjectNav-v0 by numbers": {"actions": "continuous", "stop": False},
    "InstructionFollowing-v0 by numbers": {"actions": "continuous", "stop": False},
    "AudioNav-v0 by numbers": {"actions": "continuous", "stop": False},
}


@pytest.fixture(scope="module")
def bank(tmp_path_factory):
    root = tmp_path_factory.mktemp("unseen")
    return load_bank(root, ids=generate_flats(root, HOUSES))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_experts_do_nearly_all_that_is_drawn(bank, case):
    name = case.partition(" ")[0]
    rows = {"num_tasks": EPISODES // len(HOUSES)} if name not in ("PointNav-v0", "Exploration-v0") else {}
    env = home_mjx.make(name, bank, sensors=("state",), **rows, **CASES[case])
    figures = evaluate(add_expert(env), expert_policy, None, EPISODES)
    assert figures["success"].mean() >= LEAST
