"""An environment of rows that use all that a row has room for, and these rows as lines of a file."""

import json

import pytest
from rich_rows import Rich

from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import EnvConfig, HouseholdEnv, save_tasks

SENSORS = ("state", "goal", "goal_words", "instruction", "reply")
CONFIG = EnvConfig(sensors=SENSORS, actions="discrete", physics=PhysicsConfig(impl="kinematic"))


@pytest.fixture(scope="session")
def env(generated_bank):
    return HouseholdEnv(CONFIG, Rich(stop=True, num_tasks=2, min_length=0.0)).bind(generated_bank)


@pytest.fixture(scope="session")
def lines(env, tmp_path_factory):
    path = tmp_path_factory.mktemp("rich") / "tasks.jsonl"
    save_tasks(path, env.bank, env.params.tasks)
    return [json.loads(line) for line in path.read_text().splitlines()]
