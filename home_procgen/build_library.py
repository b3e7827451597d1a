"""Build all library models from their recipes and write the files that the package ships.

python -m home_procgen.build_library
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jaxtyping
import numpy as np

from home_mjx.core.array_store import Arrays, write_entry
from home_mjx.core.files import write_atomically
from home_mjx.core.progress import say
from home_mjx.datasets.suncg.read.joints import JOINTS
from home_mjx.datasets.suncg.write.house import format_tables
from home_mjx.datasets.suncg.write.metadata import joints_csv
from home_procgen.model_codec import POSITION_DECIMALS, encode_mesh, to_grid
from home_procgen.model_library import building_models, table_rows
from home_procgen.model_store import PARTS, STORE, joint_row
from home_procgen.primitives.detail import DETAILS
from home_procgen.primitives.family import FurnitureModel
from home_procgen.things import build_models, families

ROOT = Path(__file__).parent
RECIPES = ROOT / "data" / "recipes.sha256"  # digest of the sources below
SOURCES = ("things", "primitives", "shapes", "floor_plan/structure.py", "outside/models.py", "model_codec.py")


def hash_recipes() -> str:
    """Return the SHA-256 digest of the sources from which models are built."""
    total = hashlib.sha256()
    for name in SOURCES:
        path = ROOT / name
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            total.update(file.relative_to(ROOT).as_posix().encode() + file.read_bytes().replace(b"\r\n", b"\n"))
    return total.hexdigest()


def write_models(path: Path, models: Mapping[str, Mapping[str, FurnitureModel]]) -> None:
    """Write a file for `home_procgen.model_store.ModelStore`.

    Args:
        path: The file.
        models: All models by detail and id.

    Raises:
        OSError: The file cannot be written.
    """
    arrays: Arrays = {}
    for detail, own in models.items():
        for key, model in own.items():
            arrays[f"{detail}/{key}"] = encode_mesh(model.mesh, model.slots.values())
            if model.closed is not None:
                arrays[f"{detail}/{key}_0"] = encode_mesh(model.closed, model.slots.values())
    full = models[DETAILS[0]]
    arrays[PARTS] = to_grid(np.concatenate([model.parts for model in full.values()]), POSITION_DECIMALS)
    ends = np.cumsum([len(model.parts) for model in full.values()]).tolist()
    notes: dict[str, Any] = {"families": {name: len(family.designs) for name, family in families().items()}}
    notes["tables"] = {detail: _format_tables(own) for detail, own in models.items()}
    notes["models"] = {
        key: {
            "fine": model.fine,
            "slots": model.slots,
            "parts": (end - len(model.parts), len(model.parts)),
            "closed": model.closed is not None,
            "lights": [(*light.position, light.power) for light in model.lights],
            "joints": {detail: [joint_row(joint) for joint in own[key].joints] for detail, own in models.items()},
        }
        for (key, model), end in zip(full.items(), ends, strict=True)
    }
    write_entry(path, arrays, notes)


def _format_tables(models: Mapping[str, FurnitureModel]) -> dict[str, str]:
    """Return the metadata tables of all models by file name."""
    rows = table_rows((*models.values(), *building_models().values()))
    return {**format_tables(rows), JOINTS: joints_csv(rows)}


def main() -> None:
    """Build the models and write the files."""
    jaxtyping.config.update("jaxtyping_disable", True)  # checks of annotations take half of the time
    write_models(STORE, {detail: build_models(detail) for detail in DETAILS})
    with write_atomically(RECIPES) as file:
        file.write(f"{hash_recipes()}\n".encode())
    say(f"{STORE.name}: {STORE.stat().st_size / 1e6:.1f} MB", True)


if __name__ == "__main__":
    main()
