"""Run the notebooks of docs/notebooks in this process, and store their outputs: python scripts/run_notebooks.py [NAME].

A cell's last expression is shown by `_repr_html_`, `_repr_png_` or `repr`, as Jupyter does; what it prints comes
before. Nothing but the package is needed.
"""

import ast
import base64
import contextlib
import io
import json
import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent.parent / "docs" / "notebooks"
MAX_BYTES = 200_000  # of a stored notebook


def run_notebook(notebook: dict[str, Any]) -> dict[str, Any]:
    """Return a notebook with the outputs of its code cells, run in one namespace; errors are those of the cells."""
    names: dict[str, Any] = {"__name__": "__main__"}
    cells = [cell if cell["cell_type"] != "code" else run_cell(cell, names) for cell in notebook["cells"]]
    count = iter(range(1, len(cells) + 1))
    numbered = [{**c, "execution_count": next(count)} if c["cell_type"] == "code" else c for c in cells]
    return {**notebook, "cells": numbered}


def run_cell(cell: dict[str, Any], names: dict[str, Any]) -> dict[str, Any]:
    """Return a code cell with its outputs."""
    tree, printed, value = ast.parse("".join(cell["source"])), io.StringIO(), None
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    outputs: list[dict[str, Any]] = []
    if printed.getvalue():
        outputs.append({"name": "stdout", "output_type": "stream", "text": printed.getvalue().splitlines(True)})
    if value is not None:
        outputs.append({"output_type": "display_data", "metadata": {}, "data": show(value)})
    return {**cell, "outputs": outputs}


def show(value: Any) -> dict[str, Any]:
    """Return a value by MIME type."""
    data: dict[str, Any] = {"text/plain": [f"<{type(value).__name__}>"]}
    if hasattr(value, "_repr_html_"):
        return data | {"text/html": [value._repr_html_()]}
    if hasattr(value, "_repr_png_"):
        return data | {"image/png": base64.b64encode(value._repr_png_()).decode()}
    return {"text/plain": [repr(value)]}


def main(wanted: list[str]) -> None:
    """Run the named notebooks, or all, and write them with their outputs."""
    for path in sorted(FOLDER.glob("*.ipynb")):
        if not wanted or path.stem in wanted:
            text = json.dumps(run_notebook(json.loads(path.read_text())), indent=1, ensure_ascii=False) + "\n"
            if len(text.encode()) > MAX_BYTES:
                raise SystemExit(f"{path.name} has {len(text.encode())} bytes, more than {MAX_BYTES}")
            path.write_text(text)
            print(f"{path.name}: {len(text.encode()) / 1000:.0f} kB", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
