"""A Habitat dataset's configuration: its tables of templates, and its scenes by house id."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from home_mjx.core.files import is_file
from home_mjx.datasets.gltf.scene_dataset import scene_id
from home_mjx.datasets.habitat.templates import ENDINGS, NAME_TAG, HabitatTemplate, TemplateTable, path_below
from home_mjx.datasets.suncg.formats.json_value import JsonValue, read_json
from home_mjx.errors import MissingFileError

CONFIG_ENDING = ".scene_dataset_config.json"
SCAN_DEFAULTS = {  # of a scan without a configuration: files beside it, as of HM3D and Matterport3D
    "semantic_asset": f"{NAME_TAG}.semantic.glb",
    "semantic_descriptor_filename": f"{NAME_TAG}.semantic.txt",
}
HOUSE_DEFAULTS = {
    "semantic_asset": f"{NAME_TAG}_semantic.ply",
    "semantic_descriptor_filename": f"{NAME_TAG}.house",
}


@dataclass
class HabitatSource:
    """Templates of a dataset.

    Attributes:
        path: Its configuration, or a single stage such as a scan.
        root: Folder that contains all its files.
        notes: Elements of the configuration that are not used.
    """

    path: Path
    root: Path
    notes: dict[str, str] = field(default_factory=dict)

    @cached_property
    def document(self) -> JsonValue:
        """The configuration; that of a dataset of one stage for a single asset."""
        if self.path.name.endswith(".json"):
            value = read_json(self.path)
            value.member("")  # raises unless it is an object
            return value
        house = self.path.with_name(f"{self.path.name.split('.')[0]}.house")
        defaults = HOUSE_DEFAULTS if is_file(house) else SCAN_DEFAULTS
        paths = {self.path.suffix: [self.path.name]}
        return JsonValue(self.path, "", {"stages": {"paths": paths, "default_attributes": defaults}})

    def table(self, section: str) -> TemplateTable:
        """Return the templates of a section of `ENDINGS`, listed once."""
        if section not in self._tables:
            value = self.document.member(section)
            self._tables[section] = TemplateTable(value, self.root, ENDINGS[section], self.notes)
        return self._tables[section]

    @cached_property
    def _tables(self) -> dict[str, TemplateTable]:
        """Tables that were used."""
        return {}

    @cached_property
    def scenes(self) -> Mapping[str, tuple[str, str]]:
        """Section and handle of each scene by house id: scene instances, else stages, which are scenes of their own.

        Names that occur twice are told apart by their folders.
        """
        section = "scene_instances" if self.table("scene_instances").handles else "stages"
        handles = self.table(section).handles
        names = [handle.rpartition("/")[2] for handle in handles]
        ids = [name if names.count(name) == 1 else handle for name, handle in zip(names, handles, strict=True)]
        return {scene_id(name): (section, handle) for name, handle in zip(ids, handles, strict=True)}

    def scene(self, house_id: str) -> HabitatTemplate:
        """Return the scene instance of a house; of a stage alone, one that names it."""
        section, handle = self.scenes[house_id]
        if section == "scene_instances":
            return self.table(section).read(handle)
        stage = JsonValue(self.path, "stages", {"stage_instance": {"template_name": handle}})
        defaults = self.document.member("scene_instances")
        sources = [(stage, self.path.parent)]
        if defaults.has_value and defaults.member("default_attributes").has_value:
            sources.append((defaults.member("default_attributes"), self.path.parent))
        return HabitatTemplate(handle, self.table(section).read(handle).file, tuple(sources))

    def descriptors(self, name: JsonValue) -> Iterator[Path]:
        """Yield the semantic descriptor that a scene names: by the configuration's names, else by the files it lists.

        Raises:
            DatasetError: The path leads out of the root.
        """
        section = self.document.member("semantic_scene_descriptor_instances")
        if not section.has_value or not name.has_value or not name.text():
            return
        stated = section.member(name.text())
        if stated.has_value and isinstance(stated.data, str):
            yield path_below(self.root, self.path.parent, stated)
            return
        found = self.table("semantic_scene_descriptor_instances").find(name)
        if found is not None and found.file is not None:
            yield found.file


def read_optional(path: Path, element: JsonValue, notes: dict[str, str]) -> JsonValue | None:
    """Read a JSON file that a scene can do without; None, with a note, if it is missing; else as `read_json`."""
    try:
        return read_json(path)
    except MissingFileError:
        notes[element.element] = f"`{path.name}` is missing: ignored"
        return None
