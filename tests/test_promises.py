"""docs/promises.md names tests: each is there, and each promise has one."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LINES = (ROOT / "docs" / "promises.md").read_text(encoding="utf-8").splitlines()
PAGE = LINES[: LINES.index("## What was tried")]
PROMISES = [line for line in PAGE if line.startswith("| ") and not line.startswith(("| Promise", "| ---"))]
NAMED = re.compile(r"`(test_\w+)::(test_\w+)`")


def test_every_test_that_the_promises_name_exists():
    files = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py")}
    named = [pair for line in LINES for pair in NAMED.findall(line)]
    assert len(named) > 100
    lost = [f"{file}::{name}" for file, name in named if f"\ndef {name}(" not in files.get(file, "")]
    assert lost == []


def test_every_promise_names_a_test():
    assert [line for line in PROMISES if not NAMED.search(line.split("|")[2])] == []


def test_what_is_not_promised_is_said():
    assert "## Not promised" in LINES
