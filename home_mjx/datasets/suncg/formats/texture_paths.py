"""Lookup of the image files of materials."""

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

from home_mjx.core.files import is_file, resolve_below
from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.errors import MissingFileError

EXTENSIONS = (".png", ".jpg")


class TextureLookup:
    """Lookup in the `texture/` folder of a dataset.

    Args:
        root: Absolute dataset root.
        tolerant: Accept materials whose images are missing.
    """

    def __init__(self, root: Path, tolerant: bool = False) -> None:
        self.root = root
        self.tolerant = tolerant
        self.folder = root / "texture"
        self._known: dict[str, Path | None] = {}

    def find_required(self, name: str, place: Location) -> Path:
        """Return the image of a texture named without extension as in house.json, such as `wood_8`.

        Users' pictures have names of digits and are in `texture/s/`. `place` is that of the reference, for errors.

        Raises:
            MissingFileError: The image does not exist.
            DatasetError: The name leads out of the dataset.
        """
        if resolve_below(self.root, self.folder, name) is None:
            raise escape_error(name, place)
        path = self.find(name)
        if path is None:
            hint = f"Put {name}.png or {name}.jpg into {self.folder} or name another texture."
            raise place.error(f"texture `{name}` is missing", hint, MissingFileError)
        return path

    def find(self, name: str) -> Path | None:
        """Return the image of a texture named without extension, in any case; None if missing.

        A tolerant lookup searches for a missing image at each call, others once. Names that lead out of the dataset are
        not rejected.
        """
        if self._known.get(name) is None and (self.tolerant or name not in self._known):
            self._known[name] = self._find(name)
        return self._known[name]

    def material_fields(self, name: str, find: Callable[[], Path]) -> dict[str, Any]:
        """Return {"texture": find()}; or {"missing_file": name} if that is missing and the lookup is tolerant.

        Raises:
            MissingFileError, DatasetError: As in `find_required`; a tolerant lookup does not raise `MissingFileError`.
        """
        try:
            return {"texture": find()}
        except MissingFileError:
            if not self.tolerant:
                raise
            return {"missing_file": name}

    def has_file(self, relative: str, folder: Path) -> bool:
        """Return whether a path of an MTL, relative to its folder, is an existing file below the root."""
        path = resolve_below(self.root, folder, relative)
        return path is not None and is_file(path)

    def find_color_map(self, relative: str, folder: Path, place: Location) -> Path:
        """Return the image at the path of a `map_Kd`, relative to the MTL's folder, or else by its stem in `texture/`.

        Raises:
            MissingFileError, DatasetError: As in `find_required`.
        """
        path = resolve_below(self.root, folder, relative)
        if path is None:
            raise escape_error(relative, place)
        return path if is_file(path) else self.find_required(path.stem, place)

    def _find(self, name: str) -> Path | None:
        """Return an image by name: PNG before JPG, exact case before any case, `s/` first for names of digits."""
        digits = name.isascii() and name.isdigit()
        stems = [f"s/{name}", name] if digits else [name]
        for path in (self.folder / f"{stem}{extension}" for stem in stems for extension in EXTENSIONS):
            if is_file(path):
                return path
        found = (self._any_case.get(f"{stem}{extension}".lower()) for stem in stems for extension in EXTENSIONS)
        return next((path for path in found if path), None)

    @cached_property
    def _any_case(self) -> dict[str, Path]:
        """Images by lower-case path below `texture/`, since SUNCG was written on a case-insensitive file system.

        The folder is listed once.
        """
        files = [*self.folder.glob("*"), *self.folder.glob("s/*")]
        return {path.relative_to(self.folder).as_posix().lower(): path for path in sorted(files)}


def escape_error(relative: str, place: Location) -> Exception:
    """Return, without raising it, the error for a path that leads out of the dataset root."""
    return place.error(f"path `{relative[:80]}` leads out of the dataset", "Paths must stay below the dataset root.")
