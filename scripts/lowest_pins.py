"""Print a pin for each required dependency: the lowest version that pyproject.toml allows.

python scripts/lowest_pins.py
"""

import re
import tomllib
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"


def lowest_pins(path: Path = PROJECT) -> list[str]:
    """Return `name==version` of each dependency, in order; jaxlib follows jax.

    Args:
        path: The `pyproject.toml`.
    """
    declared = tomllib.loads(path.read_text(encoding="utf-8"))["project"]["dependencies"]
    pins = [f"{name}=={version}" for name, version in re.findall(r"^([\w.-]+)>=([\w.]+)", "\n".join(declared), re.M)]
    return pins + [pin.replace("jax==", "jaxlib==") for pin in pins if pin.startswith("jax==")]


if __name__ == "__main__":
    print("\n".join(lowest_pins()))
