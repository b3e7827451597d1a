"""Run each ecosystem's API checker on every id, and write the table of docs/adapters.md.

    python scripts/check_adapters.py [--id ID ...] [--adapter NAME ...] [--out FILE] [--docs]

Prints one JSON object per line: `id`, `adapter`, `outcome` (`passed`, `refused` or `failed`), `why`, `seconds`. With
`--docs`, the last line of `--out` for each id and adapter becomes the table. Adapters whose package is not installed
keep their earlier lines. `make checkers` runs everything.
"""

import argparse
import functools
import importlib
import json
import os
import re
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "adapters.md"
BEGIN, END = "<!-- made by scripts/check_adapters.py -->", "<!-- end -->"


def main() -> int:
    """Run the checks, print the results, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--id", action="append", help="default: every id")
    parser.add_argument("--adapter", action="append", help="default: every adapter whose package is installed")
    parser.add_argument("--out", type=Path, default=ROOT / "benchmarks" / "results" / "adapters.jsonl")
    parser.add_argument("--docs", action="store_true", help="also write the table")
    parser.add_argument("--only-docs", action="store_true", help="run no checks")
    args = parser.parse_args()
    failed = 0 if args.only_docs else run(args)
    if args.docs or args.only_docs:
        write_table(args.out)
    return int(failed > 0)


def run(args: argparse.Namespace) -> int:
    """Run the checks.

    Returns:
        Number of failed checks.
    """
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    os.environ.setdefault("XLA_FLAGS", "--xla_backend_optimization_level=0")  # because most time is compilation
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.5")
    checkers = known_checkers()
    import home_mjx
    from home_mjx.core.compile_cache import use_compile_cache
    from home_mjx.registry import find_spec

    use_compile_cache()
    there = [name for name in checkers.CHECKERS if checkers.is_installed(name)]
    failed = 0
    with args.out.open("a", encoding="utf-8") as out:
        for adapter in args.adapter or there:
            for env_id in args.id or home_mjx.list_envs():
                bank = small_bank(find_spec(env_id).options.get("max_fronts", 0))
                found = judged(checkers.CHECKERS[adapter], env_id, bank)
                failed += found["outcome"] == "failed"
                line = json.dumps({"id": env_id, "adapter": adapter, **found})
                print(line, flush=True)
                print(line, file=out, flush=True)
    return failed


def known_checkers() -> Any:
    """Import the module of checkers from the tests."""
    sys.path.insert(0, str(ROOT / "tests" / "helpers"))
    return importlib.import_module("checkers")


@functools.cache
def small_bank(max_fronts: int) -> Any:
    """Return a bank of two generated houses, with up to `max_fronts` fronts that open in each."""
    from home_mjx.houses import load_bank
    from home_mjx.scene_compile.objects.fronts import ArticulationOptions
    from home_mjx.scene_compile.pipeline.compile import CompileOptions
    from home_procgen import generate_dataset

    options = CompileOptions(articulation=ArticulationOptions(max_fronts))
    with tempfile.TemporaryDirectory() as root:
        return load_bank(root, ids=generate_dataset(Path(root), range(2)), options=options)


def judged(check: Any, env_id: str, bank: Any) -> dict[str, Any]:
    """Run a checker on an id and return the outcome."""
    from home_mjx.errors import ConfigError

    begun, why = time.perf_counter(), ""
    try:
        check(env_id, bank)
        outcome = "passed"
    except ConfigError as error:
        outcome, why = "refused", said(error, env_id)
    except Exception as error:  # any error of a checker is its result
        outcome, why = "failed", f"{type(error).__name__}: {error}"[:300]
        traceback.print_exc()
    return {"outcome": outcome, "why": why, "seconds": round(time.perf_counter() - begun, 1)}


def said(error: Exception, env_id: str) -> str:
    """Return the first sentence of an error, without the name of the id."""
    return str(error).splitlines()[0].replace(env_id.partition("-")[0], "this task")


def write_table(out: Path) -> None:
    """Write the outcomes of a file into the page."""
    order = list(known_checkers().CHECKERS)
    lines = [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]
    lines.sort(key=lambda line: order.index(line["adapter"]))
    text = PAGE.read_text(encoding="utf-8")
    pattern = re.compile(f"{re.escape(BEGIN)}.*{re.escape(END)}", re.DOTALL)
    PAGE.write_text(pattern.sub(lambda _: f"{BEGIN}\n{table(lines)}\n{END}", text), encoding="utf-8")


def table(lines: list[dict[str, Any]]) -> str:
    """Format the outcomes as a Markdown table, with the reasons below.

    Example:
        >>> print(table([{"id": "A-v0", "adapter": "Brax", "outcome": "passed", "why": ""}]))
        | Id | Brax |
        | --- | --- |
        | `A-v0` | passed |
        <BLANKLINE>
    """
    found = {(line["id"], line["adapter"]): line for line in lines}
    adapters, reasons = list(dict.fromkeys(line["adapter"] for line in lines)), {}

    def cell(env_id: str, adapter: str) -> str:
        line = found.get((env_id, adapter))
        if line is None or not line["why"]:
            return line["outcome"] if line else ""
        number = reasons.setdefault(line["why"], len(reasons) + 1)
        return f"{'not applicable' if line['outcome'] == 'refused' else line['outcome']} ({number})"

    rows = [["Id", *adapters], ["---"] * (1 + len(adapters))]
    rows += [[f"`{i}`", *(cell(i, adapter) for adapter in adapters)] for i in sorted({line["id"] for line in lines})]
    said = [f"{number}. {why}" for why, number in reasons.items()]
    return "\n".join(["| " + " | ".join(row) + " |" for row in rows] + ["", *said])


if __name__ == "__main__":
    sys.exit(main())
