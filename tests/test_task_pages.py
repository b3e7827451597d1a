"""Every id has a page with a picture of an episode, all of its options with their defaults, and its baselines."""

import json
import re
from dataclasses import MISSING, Field, fields
from pathlib import Path

import pytest
from PIL import Image

import home_mjx
import home_mjx.tasks.suite
from home_mjx.registry import find_spec
from home_mjx.tasks import RowTask

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
LARGEST = 60_000  # bytes of a picture
WIDEST = 800  # [px]
IDS = tuple(
    env_id for env_id in home_mjx.list_envs() if find_spec(env_id).entry_point.startswith("home_mjx.tasks.suite:")
)
SHARED = {field.name for field in fields(RowTask)}


def page_of(env_id: str) -> Path:
    """In words: `PointNav-v0` has docs/tasks/point_nav.md, `HouseQA-v0` house_qa.md."""
    name = env_id.partition("-v")[0]
    return DOCS / "tasks" / (re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower() + ".md")


def default_of(field: Field) -> object:
    return field.default if field.default is not MISSING else field.default_factory()  # type: ignore[misc]


@pytest.mark.parametrize("env_id", IDS)
def test_a_task_has_a_page_with_a_small_picture(env_id):
    text = page_of(env_id).read_text()
    (name,) = re.findall(r"^!\[[^\]]+\]\(\.\./images/tasks/(\w+\.jpg)\)$", text, re.MULTILINE)
    picture = DOCS / "images" / "tasks" / name
    assert picture.stem == page_of(env_id).stem
    assert picture.stat().st_size <= LARGEST
    with Image.open(picture) as image:
        assert image.format == "JPEG"
        assert 400 <= image.width <= WIDEST
    assert f"tasks/{page_of(env_id).name}" in (DOCS / "tasks.md").read_text()
    assert f"tasks/{page_of(env_id).name}" in (ROOT / "mkdocs.yml").read_text()


@pytest.mark.parametrize("env_id", IDS)
def test_its_page_names_every_option_and_its_default(env_id):
    task = getattr(home_mjx.tasks.suite, find_spec(env_id).entry_point.partition(":")[2])
    told = dict(re.findall(r"^\| `(\w+)` \| ([^|]+) \|", page_of(env_id).read_text(), re.MULTILINE))
    shared = SHARED if issubclass(task, RowTask) else set()
    own = {field.name: default_of(field) for field in fields(task) if field.name not in shared}
    assert set(told) == set(own)
    for name, default in (own | dict(find_spec(env_id).options)).items():
        if name in own and not isinstance(default, tuple):
            assert told[name].strip("`") == (
                str(default).lower() if isinstance(default, bool | str) else f"{default:g}"
            )


def test_the_overview_names_the_options_of_all_rows():
    text = (DOCS / "tasks.md").read_text()
    assert [name for name in SHARED if f"`{name}`" not in text] == []


def test_tables_of_baselines_are_those_that_were_measured():
    """Figures of the pages are in the lines of the last run, for three agents of every id."""
    lines = [
        json.loads(line) for line in (ROOT / "benchmarks" / "results" / "baselines.jsonl").read_text().splitlines()
    ]
    measured = {line["id"] for line in lines}
    assert measured == set(IDS)
    whole = (DOCS / "baselines.md").read_text()
    for env_id in sorted(measured):
        last = {(line["name"], line["agent"]): line for line in lines if line["id"] == env_id}
        assert {agent for _, agent in last} == {"random", "blind", "expert"}
        for line in last.values():
            success = f"{line['success']['mean']:.2f} ± {line['success']['stderr']:.2f}"
            assert f"| {success} |" in whole
            assert f"| {success} |" in page_of(env_id).read_text()
