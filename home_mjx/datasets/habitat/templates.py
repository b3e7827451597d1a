"""Templates of a Habitat dataset: configuration files and assets by handle, found by exact or partial names."""

import os
import posixpath
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

from home_mjx.core.files import is_file, resolve_below
from home_mjx.datasets.gltf.decode.container import URI_SCHEME
from home_mjx.datasets.suncg.formats.json_value import JsonValue, read_json
from home_mjx.errors import MissingFileError

ENDINGS = {  # ending of the configuration files of each section
    "stages": ".stage_config.json",
    "objects": ".object_config.json",
    "articulated_objects": ".ao_config.json",
    "light_setups": ".lighting_config.json",
    "scene_instances": ".scene_instance.json",
    "semantic_scene_descriptor_instances": ".semantic_config.json",
}
NAME_TAG = "%%CONFIG_NAME_AS_ASSET_FILENAME%%"  # in default attributes: the asset's name without folder and endings
MAX_FILES = 200_000  # maximum number of templates of a section
MAX_CANDIDATES = 5  # maximum number of candidates in a message
ROOT_HINT = "Name the folder that holds all files by `?root=FOLDER`, or correct the path."


@dataclass(frozen=True)
class HabitatTemplate:
    """A template of a section: attributes from several places.

    Attributes:
        handle: Its name: path below the root without ending, or the name that the dataset's configuration gives it.
        file: Its configuration file or asset; None: it is stated by the dataset's configuration alone.
        sources: Attributes, those with precedence first, each with the folder that its paths are relative to.
    """

    handle: str
    file: Path | None
    sources: tuple[tuple[JsonValue, Path], ...]

    @property
    def name(self) -> str:
        """Last part of the handle."""
        return self.handle.rpartition("/")[2]

    def member(self, key: str) -> JsonValue:
        """Return an attribute of the first source that has it; null if none has."""
        return self.member_with_folder(key)[0]

    def member_with_folder(self, key: str) -> tuple[JsonValue, Path]:
        """Return an attribute of the first source that has it, and the folder of its paths; null if none has."""
        found = [(value.member(key), folder) for value, folder in self.sources]
        return next((pair for pair in found if pair[0].has_value), found[0] if found else (JsonValue(Path()), Path()))

    def text(self, key: str) -> tuple[JsonValue, Path]:
        """Return an attribute as `member_with_folder` does, with its name tag replaced by the template's file name."""
        value, folder = self.member_with_folder(key)
        if value.has_value and NAME_TAG in value.text():
            value = replace(value, data=value.text().replace(NAME_TAG, self.name.split(".")[0]))
        return value, folder


@dataclass
class TemplateTable:
    """Templates of one section, whose files are read when they are used.

    Attributes:
        section: The section of the dataset's configuration; null: it has no templates.
        root: Folder that contains all files.
        ending: Ending of its configuration files.
        notes: Elements with paths that are ignored.
    """

    section: JsonValue
    root: Path
    ending: str
    notes: dict[str, str] = field(default_factory=dict)
    _files: dict[str, Path] = field(default_factory=dict)
    _stated: dict[str, tuple[JsonValue, Path | None]] = field(default_factory=dict)
    _by_name: dict[str, list[str]] = field(default_factory=dict)
    _read: dict[str, HabitatTemplate] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.section.has_value:
            for path in self._listed():
                self._files.setdefault(self._handle(path), path)
            configs = self.section.member("configs")
            for value in configs.entries() if configs.has_value else ():
                self._add_stated(value)
        for handle in self.handles:
            self._by_name.setdefault(handle.rpartition("/")[2], []).append(handle)

    @property
    def folder(self) -> Path:
        """Folder that the dataset's configuration is in."""
        return self.section.file.parent

    @property
    def handles(self) -> tuple[str, ...]:
        """Handles of all templates, sorted."""
        return tuple(sorted({*self._files, *self._stated}))

    def path(self, handle: str) -> Path | None:
        """Return the file of one of `handles`; None if the dataset's configuration alone states it."""
        return self._stated[handle][1] if handle in self._stated else self._files.get(handle)

    def find(self, name: JsonValue) -> HabitatTemplate | None:
        """Return the template with a handle, or the only one whose handle ends with or contains a name; None if none.

        Raises:
            DatasetError: Several templates contain the name, or a file is broken.
        """
        text = self._without_ending(name.text())
        known = self._by_name.get(text.rpartition("/")[2], [])
        found = [handle for handle in known if handle == text]
        found = found or [handle for handle in known if f"/{handle}".endswith(f"/{text}")]
        found = found or [handle for handle in self.handles if text and text in handle]
        if len(found) > 1:
            shown = ", ".join(f"`{handle}`" for handle in found[:MAX_CANDIDATES])
            raise name.error(f"`{text[:60]}` is the name of {len(found)} templates", f"Name one of them: {shown}.")
        return self.read(found[0]) if found else None

    def read(self, handle: str) -> HabitatTemplate:
        """Return the template of one of `handles`; `DatasetError` if its file is broken."""
        if handle not in self._read:
            self._read[handle] = self._template(handle)
        return self._read[handle]

    def _template(self, handle: str) -> HabitatTemplate:
        """Read a template: attributes of the dataset's configuration, then its file, then the defaults."""
        sources: list[tuple[JsonValue, Path]] = []
        attributes, file = self._stated.get(handle, (None, self._files.get(handle)))
        if attributes is not None and attributes.has_value:
            sources.append((attributes, self.folder))
        if file is not None and file.name.endswith(".json"):
            if not is_file(file):
                raise self.section.error(f"file `{file}` is missing", "Fetch it.", MissingFileError)
            checked = check_below(self.root, file, self.section)
            sources.append((read_json(checked), file.parent))
        defaults = self.section.member("default_attributes")
        if defaults.has_value:
            sources.append((defaults, file.parent if file is not None else self.folder))
        return HabitatTemplate(handle, file, tuple(sources))

    def _add_stated(self, value: JsonValue) -> None:
        """Add a template that the dataset's configuration states, perhaps on top of a file."""
        original, handle = value.member("original_file"), value.member("template_handle")
        file = path_below(self.root, self.folder, original) if original.has_value else None
        name = handle.text() if handle.has_value else self._handle(file) if file is not None else None
        if name is None:
            raise value.error("template has neither `template_handle` nor `original_file`")
        self._stated[self._without_ending(name)] = (value.member("attributes"), file)

    def _listed(self) -> Iterator[Path]:
        """Yield the files of all search paths: configuration files first."""
        paths = self.section.member("paths")
        if not paths.has_value:
            return
        paths.member("")  # raises unless it is an object
        for suffix in sorted(paths.data, key=lambda key: key != ".json"):
            for value in paths.member(suffix).entries():
                yield from self._matching(value, self.ending if suffix == ".json" else suffix)

    def _matching(self, value: JsonValue, ending: str) -> Iterator[Path]:
        """Yield the files of one search path, a folder or a pattern, with an ending."""
        pattern = posixpath.normpath(value.text().replace("\\", "/"))
        start = resolve_below(self.root, self.folder, pattern)
        if URI_SCHEME.match(pattern) or "\0" in pattern or start is None or posixpath.isabs(pattern):
            self.notes[value.element] = "search path leads out of the dataset: ignored"
            return
        relative = os.path.relpath(start, self.root)
        try:
            matches = [self.root] if relative == "." else sorted(islice(self.root.glob(relative), MAX_FILES))
            files = [file for found in matches for file in (sorted(found.iterdir()) if found.is_dir() else [found])]
        except (ValueError, OSError) as error:
            raise value.error(f"not a search path: {error}") from None
        yield from (file for file in files[:MAX_FILES] if file.name.endswith(ending))

    def _handle(self, path: Path) -> str:
        """Return the handle of a file."""
        return self._without_ending(Path(os.path.relpath(path, self.root)).as_posix())

    def _without_ending(self, name: str) -> str:
        """Return a name without the ending of a configuration file or an asset."""
        endings = (self.ending, ".basis.glb", ".glb", ".gltf", ".urdf", ".ply", ".json")
        ending = next((ending for ending in endings if name.endswith(ending) and len(name) > len(ending)), "")
        return name.removesuffix(ending)


def path_below(root: Path, folder: Path, value: JsonValue) -> Path:
    """Return the path that a text names; it need not exist.

    Raises:
        DatasetError: It is absolute, has a scheme, or leads out of the root, also by a symbolic link.
    """
    text = value.text()
    if not text or "\0" in text or URI_SCHEME.match(text) or text.startswith(("/", "\\")):
        raise value.error(f"expected a relative path, got `{text[:60]}`", ROOT_HINT)
    path = resolve_below(root, folder, text)
    if path is None:
        raise value.error(f"`{text[:60]}` leads out of the folder {root}", ROOT_HINT)
    return check_below(root, path, value)


def check_below(root: Path, path: Path, value: JsonValue) -> Path:
    """Return a path unchanged; raise `DatasetError` if symbolic links lead out of the root."""
    if not path.resolve().is_relative_to(root.resolve()):
        raise value.error(f"`{path.name[:60]}` leads out of the folder {root}", ROOT_HINT)
    return path
