"""Every Python block of README and the guides runs, page by page: a later block may use what an earlier one made.

A block that cannot run has `<!-- not run: reason -->` on the line above it.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import pytest
from generated import generate_flats

ROOT = Path(__file__).resolve().parent.parent
PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md")))
FENCE = re.compile(
    r"(?:<!-- not run: (?P<reason>[^\n]+) -->\n+)?^```python\n(?P<code>.*?)^```", re.MULTILINE | re.DOTALL
)
# The guides show useful sizes; here they only have to run.
SMALLER = (
    (r"\b64\b(?! *\* *64)", "4"),
    (r"range\((?:100|1000)\)", "range(2)"),
    (r"\b1000\b", "8"),
    (r"num_houses=(?:8|16)", "num_houses=2"),
    (r'"procedural:([12])"', r'"procedural:\1?preset=flat"'),
    (r'"procedural:8"', '"procedural:3?preset=flat"'),
    (r"num_slots=8", "num_slots=2"),
    (r"num_timesteps=\d+", "num_timesteps=8"),
    (r"episode_length=100", "episode_length=4"),
)


@dataclass(frozen=True)
class Block:
    """One block: its code, the line where it begins, and why it does not run, if so."""

    code: str
    line: int
    reason: str | None


def blocks(page: Path) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    found = FENCE.finditer(text)
    return [Block(m[2], text.count("\n", 0, m.start(2)) + 1, m[1]) for m in found]


def name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


WITH_BLOCKS = [page for page in PAGES if blocks(page)]


def smaller(code: str) -> str:
    for pattern, text in SMALLER:
        code = re.sub(pattern, text, code)
    return code


@pytest.fixture(scope="module")
def houses(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a dataset `houses`, which the guides name."""
    folder = tmp_path_factory.mktemp("guides")
    generate_flats(folder / "houses", range(3))
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("page", WITH_BLOCKS, ids=name)
def test_blocks_run_page_by_page(page: Path, houses: Path, monkeypatch: pytest.MonkeyPatch):
    if name(page) == "docs/adapters.md":
        for package in ("brax", "jaxmarl", "pettingzoo"):
            pytest.importorskip(package)
    if name(page) == "docs/training.md":
        pytest.importorskip("flax")
    if name(page) == "docs/trajectories.md":
        pytest.importorskip("pyarrow")
    monkeypatch.chdir(houses)
    namespace: dict = {"__name__": "__main__"}
    for block in blocks(page):
        if block.reason is None:
            # Line numbers in a traceback are those of the page.
            code = "\n" * (block.line - 1) + smaller(block.code)
            exec(compile(code, name(page), "exec"), namespace)


def test_blocks_are_found_with_their_reasons(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text(
        "a\n\n```python\nx = 1\n```\n\n<!-- not run: no network -->\n```python\ny\n```\n```console\nls\n```\n"
    )
    assert blocks(page) == [Block("x = 1\n", 4, None), Block("y\n", 9, "no network")]


def test_most_blocks_run():
    """The marker is for the few that need what a test does not have."""
    every = [block for page in PAGES for block in blocks(page)]
    assert len(every) >= 14
    assert sum(block.reason is not None for block in every) <= len(every) // 5
