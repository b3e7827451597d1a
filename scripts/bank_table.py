"""Print the table of a bank's arrays for docs/bank.md: `python scripts/bank_table.py`."""

import numpy as np

from home_mjx.bank.records.bank_arrays import declarations
from home_mjx.bank.records.declaration import ROW_KINDS, Declaration

OWNERS = {"node": "Tree", "model": "Model", "triangle": "Model", "shared": "SharedRows"}


def rows() -> list[str]:
    """Return one line of Markdown per array."""
    return [
        f"| `{d.name}` | `({', '.join(d.axes)})` | {d.dtype} | {_source(d)} | {_fill(d)} | {_escaped(d.doc)} |"
        for d in declarations()
    ]


def _source(d: Declaration) -> str:
    if isinstance(d.source, str):
        return f"`{OWNERS.get(d.kind, 'CompiledHouse')}.{d.source}`"
    return f"`{d.source.__name__}()`"


def _fill(d: Declaration) -> str:
    if d.kind not in ("h", *ROW_KINDS) or d.axes == ("h",):
        return ""
    return str(np.asarray(d.fill).tolist()).replace("'", "")


def _escaped(text: str) -> str:
    return text.replace("|", "\\|").replace("<<", "\\<<")


if __name__ == "__main__":
    print("\n".join(rows()))
