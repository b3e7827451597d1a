"""Rules of docs/language.md that can be counted: openings of docstrings, words, width of pages, commit subjects."""

import ast
import io
import re
import subprocess
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = sorted(p for p in (ROOT / "home_mjx").iterdir() if (p / "__init__.py").exists())
PARTS = [*PACKAGES, ROOT / "home_procgen", ROOT / "benchmarks", ROOT / "examples", ROOT / "scripts"]
QUESTIONS = {"what", "which", "where", "how", "whether", "who", "whose", "why", "of", "that"}
NOT_VERBS = {
    "a",
    "an",
    "the",
    "all",
    "each",
    "every",
    "one",
    "no",
    "nothing",
    "its",
    "their",
    "as",
    "in",
    "by",
    "for",
    "to",
}
MAX_QUESTIONS = 0.01  # of docstrings
MIN_VERBS = 0.7  # of functions
MAX_WHAT = 2.0  # per 1,000 words
MAX_COLUMNS = 120
MAX_SUBJECT = 72
BANNED = re.compile(
    r"\b(so (many|much|near|far) (as|that|steps|rays|houses)|as far as that|is no [a-z]+class|has not the|"
    r"that there (is|are) not)\b",
    re.IGNORECASE,
)
RULES_FROM = "2026-11-26T19:40:00"  # commits before that follow no rule


@cache
def documented(part: Path) -> tuple[tuple[str, str, str], ...]:
    """Kind, place and docstring of everything that has one in a folder; the first generator is left as it was."""
    found = []
    for path in sorted(part.rglob("*.py")):
        if "v1" in path.relative_to(ROOT).parts:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                doc = ast.get_docstring(node)
                if doc:
                    found.append((kind_of(node), f"{path.relative_to(ROOT)}:{getattr(node, 'lineno', 1)}", doc))
    return tuple(found)


def kind_of(node: ast.AST) -> str:
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        return "thing"
    return "property" if any("property" in ast.unparse(d) for d in node.decorator_list) else "function"


def first_word(doc: str) -> str:
    match = re.match(r"[\W_]*([A-Za-z]+)", doc)
    return match[1].lower() if match else ""


def comments(part: Path) -> Iterator[str]:
    for path in part.rglob("*.py"):
        for token in tokenize.generate_tokens(io.StringIO(path.read_text()).readline):
            if token.type == tokenize.COMMENT:
                yield token.string


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
def test_docstrings_open_with_a_verb_or_a_noun(part: Path):
    docs = documented(part)
    asked = [f"{place}: {doc[:80]}" for _, place, doc in docs if first_word(doc) in QUESTIONS]
    assert len(asked) <= MAX_QUESTIONS * len(docs), asked[:10]
    functions = [(place, doc) for kind, place, doc in docs if kind == "function"]
    nouns = [f"{place}: {doc[:80]}" for place, doc in functions if first_word(doc) in NOT_VERBS | QUESTIONS]
    assert len(nouns) <= (1 - MIN_VERBS) * len(functions), nouns[:10]


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
def test_words_of_the_field(part: Path):
    text = "\n".join([*(doc for _, _, doc in documented(part)), *comments(part)])
    words = len(re.findall(r"[A-Za-z']+", text))
    what = len(re.findall(r"\bwhat\b", text, re.IGNORECASE))
    assert what <= max(MAX_WHAT * words / 1000, 1), f"{what} of {words} words"
    assert [match[0] for match in BANNED.finditer(text)] == []


def pages() -> list[Path]:
    return [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def prose_lines(page: Path) -> Iterator[tuple[int, str]]:
    fenced = False
    for number, line in enumerate(page.read_text().split("\n"), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield number, line


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.relative_to(ROOT).as_posix())
def test_pages(page: Path):
    lines = list(prose_lines(page))
    wide = [number for number, line in lines if len(line) > MAX_COLUMNS and not line.startswith("|")]
    assert wide == []
    text = "\n".join(line for _, line in lines)
    words, what = len(re.findall(r"[A-Za-z']+", text)), len(re.findall(r"\bwhat\b", text, re.IGNORECASE))
    assert what <= max(MAX_WHAT * words / 1000, 1), f"{what} of {words} words"
    assert [match[0] for match in BANNED.finditer(text)] == []


def test_commit_subjects_are_short():
    log = ["git", "log", "--no-merges", f"--since={RULES_FROM}", "--format=%s"]
    done = subprocess.run(log, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        pytest.skip("not a git checkout")
    subjects = [line for line in done.stdout.split("\n") if line]
    assert [subject for subject in subjects if len(subject) > MAX_SUBJECT] == []
