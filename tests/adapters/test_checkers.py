"""Every id before each ecosystem's own checker; docs/adapters.md has the outcomes as a table."""

import re
from pathlib import Path

import pytest
from checkers import CHECKERS, is_installed, team_of

import home_mjx
from home_mjx.errors import ConfigError
from home_mjx.registry import find_spec

PAGE = Path(__file__).resolve().parents[2] / "docs" / "adapters.md"
SPEAKING = ("HouseQA-v0", "VQA-v0", "Dialogue-v0", "Communication-v0")
REFUSED = {
    "Brax": dict.fromkeys(SPEAKING, "speak"),
    "gymnax": {"Communication-v0": "one agent"},
}
REFUSED["Playground"] = REFUSED["Brax"]
IDS = tuple(
    env_id for env_id in home_mjx.list_envs() if find_spec(env_id).entry_point.startswith("home_mjx.tasks.suite:")
)


@pytest.mark.slow
@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize("adapter", CHECKERS)
def test_its_checker_takes_every_id(adapter, env_id, generated_bank, articulated_bank):
    """Or the adapter says why it does not."""
    if not is_installed(adapter):
        pytest.skip(f"the package of {adapter} is not installed")
    bank = articulated_bank if "max_fronts" in find_spec(env_id).options else generated_bank
    why = REFUSED.get(adapter, {}).get(env_id)
    if why is None:
        CHECKERS[adapter](env_id, bank)
    else:
        with pytest.raises(ConfigError, match=why):
            CHECKERS[adapter](env_id, bank)


def test_the_guide_has_an_outcome_for_every_id_and_adapter():
    """And it is the one that the test above asserts."""
    rows = [
        line.strip("| ").split(" | ")
        for line in PAGE.read_text().splitlines()
        if line.startswith("| Id") or "-v0` |" in line
    ]
    assert rows[0] == ["Id", *CHECKERS]
    found = {
        (adapter, row[0].strip("`")): cell for row in rows[1:] for adapter, cell in zip(CHECKERS, row[1:], strict=True)
    }
    for adapter in CHECKERS:
        for env_id in IDS:
            refused = env_id in REFUSED.get(adapter, {})
            assert re.fullmatch(r"not applicable \(\d\)" if refused else "passed", found[adapter, env_id])


def test_teams_have_two_agents_or_as_many_as_the_task_needs():
    assert [team_of(env_id) for env_id in ("PointNav-v0", "Communication-v0", "PiedPiper-v0")] == [2, 2, 3]
