"""Furniture of this package for houses whose own models are not public; see `home_mjx.datasets.furniture`."""

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from home_mjx.datasets.furniture import DoorMesh, FurniturePiece
from home_mjx.schema.house import Joint, Material, Mesh
from home_procgen.foreign.plain_shapes import SHAPES, plain_shape
from home_procgen.foreign.worktops import worktop
from home_procgen.model_library import write_textures_named
from home_procgen.model_store import library
from home_procgen.primitives.categories import CATEGORIES
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.solids import Solid, to_mesh
from home_procgen.textures.finishes import FINISHES, default_materials
from home_procgen.textures.recipes import ALL_NAMES, METRES, repeat_uv
from home_procgen.things.openings.doors import door, double_door
from home_procgen.things.openings.leaves import FRAME_DEPTH, JAMB_WIDTH, frame

# Fine category that the library lacks -> families of models that look like it, the best first.
FAMILIES: Mapping[str, tuple[str, ...]] = {
    "blinds": ("curtain",),
    "container": ("basket",),
    "cooker": ("cooker",),
    "counter": ("kitchen_cabinet",),
    "daybed": ("single_bed",),
    "drink": ("bottle",),
    "lounge_chair": ("armchair",),
    "medicine_cabinet": ("hanging_cabinet",),
    "nightstand": ("nightstand",),
    "shower_faucet": ("soap_dispenser",),
    "stool": ("stool",),
    "straight_chair": ("chair",),
    "television": ("television",),
    "wall_shelf": ("shelving",),
}
# The same where it hangs on a wall.
WALL_FAMILIES: Mapping[str, tuple[str, ...]] = {"television": ("wall_television",), "decoration": ("wall_ornament",)}
MAX_EXTRA_STRETCH = 0.3  # beyond that of the model that fits best; the others within it are alternatives
MAX_ALTERNATIVES = 6
MAX_TURNED_EDGE = 0.5  # [m], longest edge of a model that may be turned by a quarter to fit
WORKTOP_CATEGORY = "counter"
STYLES = ("panels", "flat", "four", "lattice", "lines", "boards")  # of doors
WIDE_OPEN = np.pi / 2  # [rad]


class ForeignFurniture:
    """Models, doors and materials by category, size and a text that selects among alternatives."""

    version = "1"  # increase it whenever the same arguments would return something else
    texture_edge = float(METRES)

    def piece(
        self, word: str, fine: str, size: tuple[float, float, float] | None, seed: str, shape: str = ""
    ) -> FurniturePiece | None:
        """Return a model of a category, stretched to a size; see `home_mjx.datasets.furniture.FurnitureProvider`."""
        if fine == WORKTOP_CATEGORY and size is not None:
            return _worktop(shape or "I", size)
        if word in SHAPES and size is not None:
            return _plain(word, size)
        models = _candidates(fine, shape == "wall")
        if not models:
            return None
        model, quarter = _choose(models, size or tuple(models[0].size.tolist()), seed)
        turned = size if size is None or not quarter else (size[2], size[1], size[0])
        scale = np.ones(3) if turned is None else np.asarray(turned) / np.maximum(model.size, 1e-3)
        x, y, z = scale.tolist()
        return FurniturePiece(
            model.id, _centred(model.id), (x, y, z), quarter, _materials(model, seed), model.lights, f"own {model.fine}"
        )

    def doors(self, width: float, height: float, leaves: int, turn: float, seed: str) -> DoorMesh:
        """Return a door as shown, opened by `turn` [rad], of 1 or 2 leaves."""
        return _doors(round(width, 2), round(height, 2), leaves, round(turn, 2), pick(seed, len(STYLES)))

    def frame(self, width: float, height: float) -> Mesh:
        """Return the frame of a doorway without a leaf."""
        return _frame(round(width, 2), round(height, 2))

    def surface(self, family: str, seed: str, name: str) -> Material:
        """Return a material of a texture family, such as `prkt` or `tile`; its path is relative."""
        names = [found for found in ALL_NAMES if found.rpartition("_")[0] == family]
        return Material(name, (1.0, 1.0, 1.0), Path("texture") / f"{names[pick(seed, len(names))]}.png", 1.0)

    def categories(self) -> Mapping[str, tuple[str, str]]:
        """Return the coarse and the NYU40 category of each fine one of the library."""
        return {fine: (row.coarse, row.nyu40) for fine, row in CATEGORIES.items()}

    def write_textures(self, root: Path, names: set[str]) -> None:
        """Write the textures with some names, those that are missing or damaged, below a folder."""
        (root / "texture").mkdir(parents=True, exist_ok=True)
        write_textures_named(root, names)


def pick(seed: str, count: int) -> int:
    """Return a number below `count` that depends on a text alone.

    Example:
        >>> 0 <= pick("Chair_1", 5) < 5
        True
    """
    return zlib.crc32(seed.encode(errors="backslashreplace")) % count


@cache
def _candidates(fine: str, on_wall: bool) -> tuple[FurnitureModel, ...]:
    """Return the models of a fine category, or of the families that look like it."""
    families = (WALL_FAMILIES.get(fine, ()) if on_wall else ()) or FAMILIES.get(fine, ())
    return tuple(m for m in library().values() if (m.family in families if families else m.fine == fine))


@lru_cache(maxsize=20_000)
def _choose(
    models: tuple[FurnitureModel, ...], size: tuple[float, float, float], seed: str
) -> tuple[FurnitureModel, int]:
    """Return one of the models that need the least stretch, and the quarter turns that it needs, 0 or 1."""
    target = np.log(np.maximum(np.array(size), 1e-3))
    quarters = (0, 1) if max(size) <= MAX_TURNED_EDGE else (0,)
    costs = [
        (float(abs(target[[2, 1, 0] if quarter else [0, 1, 2]] - np.log(model.size)).sum()), model.id, quarter)
        for model in models
        for quarter in quarters
    ]
    costs.sort()
    near = [row for row in costs if row[0] <= costs[0][0] + MAX_EXTRA_STRETCH][:MAX_ALTERNATIVES]
    _, name, quarter = near[pick(seed, len(near))]
    return next(model for model in models if model.id == name), quarter


@cache
def _centred(model_id: str) -> Mesh:
    """Return the mesh of a model with the middle of its base at the origin."""
    model = library()[model_id]
    (x0, y0, z0), (x1, _, z1) = model.box.tolist()
    shift = np.array([(x0 + x1) / 2, y0, (z0 + z1) / 2])
    return replace(model.mesh, vertices=model.mesh.vertices - shift)


def _materials(model: FurnitureModel, seed: str) -> tuple[Material, ...]:
    """Return a material per slot, one per finish, chosen by the text."""
    chosen: dict[str, Material] = {}
    for finish in model.slots.values():
        options: Sequence[Material] = FINISHES[finish]
        chosen.setdefault(finish, options[pick(f"{seed}/{finish}", len(options))])
    return tuple(replace(chosen[finish], name=slot, opacity=None) for slot, finish in model.slots.items())


def _plain(word: str, size: tuple[float, float, float]) -> FurniturePiece:
    mesh = _plain_mesh(word)
    x, y, z = (np.asarray(size) / np.ptp(mesh.vertices, axis=0)).tolist()
    return FurniturePiece(f"plain_{word}", mesh, (x, y, z), 0, (), (), f"a plain {SHAPES[word][0]}")


@cache
def _plain_mesh(word: str) -> Mesh:
    return plain_shape(word)


@cache
def _worktop(shape: str, size: tuple[float, float, float]) -> FurniturePiece:
    """Return a worktop on cabinets, built for its size rounded to 5 cm and then stretched."""
    rounded = tuple(max(round(edge * 20) / 20, 0.3) for edge in size)
    width, height, depth = rounded
    key = f"worktop_{shape}_{width:.2f}_{height:.2f}_{depth:.2f}"
    mesh = _mesh(key, list(worktop(shape, width, height, depth)), {"paint": "paint", "stone": "stone"})
    x, y, z = (np.asarray(size) / np.ptp(mesh.vertices, axis=0)).tolist()
    return FurniturePiece(key, mesh, (x, y, z), 0, (), (), "an own worktop")


@cache
def _doors(width: float, height: float, leaves: int, turn: float, style: int) -> DoorMesh:
    key = f"own_door_{leaves}_{width:.2f}_{height:.2f}_{style}_{turn:.2f}"
    build = door if leaves == 1 else double_door
    solids, fixed = list(build(width, height, turn, STYLES[style])), len(list(frame(width, height)))
    ends = np.cumsum([0, *(len(solid.faces) for solid in solids)])
    cuts = np.linspace(fixed, len(solids), leaves + 1).astype(int)  # leaves have equal numbers of solids
    joints = tuple(
        _hinge(key, number, side, width, turn, (int(ends[first]), int(ends[last]) - 1))
        for number, (side, first, last) in enumerate(zip((-1, 1), cuts[:-1], cuts[1:], strict=False), 1)
    )
    return DoorMesh(key, _mesh(key, solids, None, style), joints)


def _hinge(key: str, number: int, side: int, width: float, turn: float, faces: tuple[int, int]) -> Joint:
    """Return the hinge of a leaf, 0 as shown; the one at -x opens by a positive angle, the one at +x by a negative."""
    closed, wide = side * turn, side * (turn - WIDE_OPEN)
    point = (side * (width / 2 - JAMB_WIDTH), 0.0, -FRAME_DEPTH / 2)
    ends = min(closed, wide), max(closed, wide)
    return Joint(key, f"leaf_{number}", "hinge", (0.0, 1.0, 0.0), point, *ends, (faces,), closed)


@cache
def _frame(width: float, height: float) -> Mesh:
    return _mesh(f"own_frame_{width:.2f}_{height:.2f}", list(frame(width, height)), None)


def _mesh(key: str, solids: list[Solid], finishes: Mapping[str, str] | None, number: int = 0) -> Mesh:
    """Join solids into a mesh with the materials of their slots."""
    names = list(dict.fromkeys(str(solid.material) for solid in solids))
    slots = {name: (finishes or {}).get(name, name.rstrip("_0123456789")) for name in names}
    materials = default_materials(slots, number)
    return repeat_uv(to_mesh(Path("object") / f"{key}.obj", solids, names, materials), slots.values())
