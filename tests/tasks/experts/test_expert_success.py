"""Experts succeed: in whole episodes of every task as it is registered, in houses that nothing was tuned on."""

import pytest
from generated import generate_flats

import home_mjx
from home_mjx.houses import load_bank
from home_mjx.registry import find_spec
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions
from home_mjx.tasks import add_expert
from home_mjx.training.evaluation import evaluate, expert_policy

LEAST = 0.99  # share of episodes that succeed
LEAST_OF_CONTAINERS = 0.95  # of FetchFromContainer: of 24 episodes one may fail
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
    "FetchFromContainer-v0": {},
    "RoomNav-v0 by numbers": {"actions": "continuous", "stop": False},
    "ObjectNav-v0 by numbers": {"actions": "continuous", "stop": False},
    "InstructionFollowing-v0 by numbers": {"actions": "continuous", "stop": False},
    "AudioNav-v0 by numbers": {"actions": "continuous", "stop": False},
}


@pytest.fixture(scope="module")
def bank(tmp_path_factory):
    root = tmp_path_factory.mktemp("unseen")
    return load_bank(root, ids=generate_flats(root, HOUSES))


@pytest.fixture(scope="module")
def with_fronts(tmp_path_factory):
    root = tmp_path_factory.mktemp("fronts")
    options = CompileOptions(articulation=ArticulationOptions(24))
    return load_bank(root, ids=generate_flats(root, HOUSES), options=options)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_experts_do_nearly_all_that_is_drawn(bank, with_fronts, case):
    name = case.partition(" ")[0]
    rows = {"num_tasks": EPISODES // len(HOUSES)} if name not in ("PointNav-v0", "Exploration-v0") else {}
    houses = with_fronts if "max_fronts" in find_spec(name).options else bank
    env = home_mjx.make(name, houses, sensors=("state",), **rows, **CASES[case])
    figures = evaluate(add_expert(env), expert_policy, None, EPISODES)
    assert figures["success"].mean() >= (LEAST_OF_CONTAINERS if name == "FetchFromContainer-v0" else LEAST)
