"""Source of the shipped default homes: their archive, the digest of their inputs, models and textures."""

import hashlib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from home_mjx.core.files import read_code
from home_mjx.core.progress import plural, track
from home_mjx.core.workers import usable_cores
from home_mjx.schema.compiled import Model
from home_mjx.schema.house import Mesh
from home_procgen.presets import Variant

ROOT = Path(__file__).parent
ARCHIVE = ROOT / "data" / "homes.zip"
BUILD_CODE = ("build_library.py",)  # code that runs only where models are built; the models themselves are hashed
WRITERS = "datasets/suncg/write"  # folder of `home_mjx` that writes generated houses and is not part of its compiler


@cache
def hash_inputs() -> bytes:
    """Return the SHA-256 digest of all code and data from which homes are generated, apart from the compiler.

    Comments and docstrings do not count.
    """
    spec = find_spec("home_mjx")
    assert spec is not None
    assert spec.origin is not None
    writers = Path(spec.origin).parent / WRITERS
    code = [path for path in sorted(ROOT.rglob("*.py")) if path.name not in BUILD_CODE]
    total = hashlib.sha256()
    for base, paths in ((ROOT, [*code, ROOT / "data" / "models.zip"]), (writers, sorted(writers.rglob("*.py")))):
        for path in paths:
            data = read_code(path).encode() if path.suffix == ".py" else path.read_bytes()
            total.update(path.relative_to(base).as_posix().encode() + b"\0" + hashlib.sha256(data).digest())
    return total.digest()


@dataclass(frozen=True)
class ShippedHomes:
    """Homes that are shipped compiled; implements `home_mjx.datasets.base.ShippedSource`.

    Attributes:
        root: Folder of the generated dataset.
        variant: Variant of its homes.
    """

    root: Path
    variant: Variant
    path: Path = ARCHIVE

    def digest(self) -> bytes:
        """Return the digest of the inputs."""
        return hash_inputs()

    def library_model(self, key: str) -> Model | None:
        """Return the compiled model with a key, from the library's mesh; None if the library lacks its mesh."""
        from home_mjx.scene_compile.objects.placed_objects import library_model

        name = key.rpartition(":")[0]
        mesh = _library_mesh(name, self.variant.detail)
        return None if mesh is None else library_model(name, as_read(mesh))

    def write_textures(self, paths: Sequence[str], progress: bool = False) -> None:
        """Write the textures that are missing or damaged, on all cores.

        Raises:
            DatasetError: The folder cannot be written.
        """
        from home_procgen.dataset_writer import claim_root
        from home_procgen.model_library import has_intact_texture, save_intact_index, write_textures_named

        claim_root(self.root, self.variant)
        names = [Path(path).stem for path in paths]
        missing = [name for name in names if not has_intact_texture(self.root, name)]
        if missing:
            text = f"drawing {plural(len(missing), 'texture')} (once, then cached)"
            with ThreadPoolExecutor(usable_cores()) as pool:
                drawn = pool.map(lambda name: write_textures_named(self.root, {name}), missing)
                for _ in track(drawn, text, "textures", progress, total=len(missing)):
                    pass
            save_intact_index(self.root)


def _library_mesh(name: str, detail: str) -> Mesh | None:
    """Return the mesh with a name, such as `home_door_1` or its closed variant `home_door_1_0`; None if unknown."""
    from home_procgen.model_store import library_model, model_store

    if model_store().has(name):
        return library_model(name, detail).mesh
    base = name.rpartition("_")[0]
    return library_model(base, detail).closed if name.endswith("_0") and model_store().has(base) else None


def as_read(mesh: Mesh) -> Mesh:
    """Return a library mesh as it is read after it was written as OBJ: order of faces and rounded normals."""
    from home_mjx.datasets.suncg.formats.obj_faces import keep_smooth_normals
    from home_mjx.datasets.suncg.write.obj import face_order, rounded

    order = face_order(mesh)
    faces = mesh.faces[order]
    normal = mesh.normal
    if normal is not None:
        normal = keep_smooth_normals(rounded(normal[order].reshape(-1, 3)), mesh.vertices[faces])
    parts = {name: getattr(mesh, name)[order] for name in ("uv", "slot", "group")}
    return replace(mesh, faces=faces, normal=normal, **parts)
