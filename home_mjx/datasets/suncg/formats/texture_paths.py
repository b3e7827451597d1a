"""Finds the image files that materials name."""

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

from home_mjx.core.files import below, is_file
from home_mjx.datasets.suncg.formats.element import Place
from home_mjx.errors import MissingFileError

EXTENSIONS = (".png", ".jpg")


class Textures:
    """The `texture/` folder of a dataset.

    Args:
        root: Absolute dataset root.
        tolerant: Whether materials may name images that are not there.
    """

    def __init__(self, root: Path, tolerant: bool = False) -> None:
        self.root = root
        self.tolerant = tolerant
        self.folder = root / "texture"
        self._known: dict[str, Path | None] = {}

    def named(self, name: str, place: Place) -> Path:
        """The image of a texture named without extension, as in house.json.

        Args:
            name: Such as `wood_8`; pictures of users have digits only and are in `texture/s/`.
            place: Who asks, for the error.

        Raises:
            MissingFileError: There is no such image.
            DatasetError: The name leads out of the dataset.
        """
        if below(self.root, self.folder, name) is None:
            raise escape(name, place)
        path = self.find(name)
        if path is None:
            hint = f"Put {name}.png or {name}.jpg into {self.folder} or name another texture."
            raise place.error(f"texture `{name}` is missing", hint, MissingFileError)
        return path

    def find(self, name: str) -> Path | None:
        """The image of a texture, None if there is none; a tolerant one looks again each time."""
        if self._known.get(name) is None and (self.tolerant or name not in self._known):
            self._known[name] = self._find(name)
        return self._known[name]

    def of_material(self, name: str, find: Callable[[], Path]) -> dict[str, Any]:
        """The field `texture` of a material; where that is tolerated, `lacking` instead if the image is missing.

        Args:
            name: Of the texture, without extension.
            find: Finds its image.

        Raises:
            MissingFileError, DatasetError: As in `named`; a tolerant one does not raise `MissingFileError`.
        """
        try:
            return {"texture": find()}
        except MissingFileError:
            if not self.tolerant:
                raise
            return {"lacking": name}

    def mapped(self, relative: str, folder: Path, place: Place) -> Path:
        """The image of a `map_Kd`, or one of the same stem in `texture/`.

        Args:
            relative: Path as in the MTL, such as `../../texture//wood_8.jpg`.
            folder: Folder of the MTL.
            place: The line of the MTL, for the error.

        Raises:
            MissingFileError, DatasetError: As in `named`.
        """
        path = below(self.root, folder, relative)
        if path is None:
            raise escape(relative, place)
        return path if is_file(path) else self.named(path.stem, place)

    def _find(self, name: str) -> Path | None:
        digits = name.isascii() and name.isdigit()
        stems = [f"s/{name}", name] if digits else [name]
        for path in (self.folder / f"{stem}{extension}" for stem in stems for extension in EXTENSIONS):
            if is_file(path):
                return path
        found = (self._any_case.get(f"{stem}{extension}".lower()) for stem in stems for extension in EXTENSIONS)
        return next((path for path in found if path), None)

    @cached_property
    def _any_case(self) -> dict[str, Path]:
        # SUNCG was written on a file system that ignores case.
        files = [*self.folder.glob("*"), *self.folder.glob("s/*")]
        return {path.relative_to(self.folder).as_posix().lower(): path for path in sorted(files)}


def escape(relative: str, place: Place) -> Exception:
    """The error of a path that leads out of the dataset root."""
    return place.error(f"path `{relative[:80]}` leads out of the dataset", "Paths must stay below the dataset root.")
