"""Compiled houses on disk, addressed by what they were compiled from.

Below the cache folder lies one folder per version of the format and the compiler; in it `houses/` and `models/`, since
houses share most models. Entries are written whole or not at all, and checked by their CRCs, see `entry`.
"""

import hashlib
import logging
import os
import weakref
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from home_mjx.core.array_store.entry import BROKEN, SUFFIX, read_entry, read_notes, write_entry
from home_mjx.core.array_store.flatten import Notes, flatten, rebuild
from home_mjx.core.files import below
from home_mjx.datasets.base import Dataset
from home_mjx.houses.integrity import check_house, check_models
from home_mjx.houses.selection import HouseContents, contents_of
from home_mjx.houses.version import claim, mark_used, version_folder
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions, compile_house
from home_mjx.schema.compiled import CompiledHouse, Model, Rooms
from home_mjx.schema.house import StandIn

log = logging.getLogger(__name__)


class HouseCache:
    """Compiled houses of one dataset, from disk if nothing that they depend on has changed.

    What houses share, such as the files of a model, is looked at once; so make a new one to see changes. Files are read
    only if their size or times say that they may have changed, see `datasets.suncg.digest_index`.

    Args:
        dataset: An open dataset.
        options: How its houses are compiled.
        library: Models by key that other houses have brought; new ones are added, so that houses share them.

    Example:
        >>> houses = HouseCache(open_dataset("datasets/demo"))  # doctest: +SKIP
        >>> houses.load("0004d52d1aeeb8ae6de39d6bd993e992").report["rooms"]  # doctest: +SKIP
        4
    """

    def __init__(
        self, dataset: Dataset, options: CompileOptions = DEFAULT_OPTIONS, library: dict[str, Model] | None = None
    ) -> None:
        self.dataset = dataset
        self.options = replace(options, read=dataset.resolved(options.read))  # part of the key
        self.library: dict[str, Model] = {} if library is None else library
        self.compiled = 0  # houses that were not in the cache
        self.unwritten: OSError | None = None  # why the last one that was compiled is not in it
        self.stand_ins: dict[str, tuple[StandIn, ...]] = {}  # of the houses that were loaded
        self._root = str(dataset.root)
        self._inputs = dataset.inputs()
        weakref.finalize(self, self._inputs.save)
        self._folder = version_folder()
        mark_used(self._folder)

    def load(self, house_id: str) -> CompiledHouse:
        """A compiled house.

        A broken entry is compiled and written again; a folder that cannot be written to only costs time.

        Raises:
            DatasetError: The house is unknown or broken.
        """
        self.dataset.check_known(house_id)
        entry = self.entry(house_id)
        broken = False
        try:
            return self._read(house_id, entry)
        except FileNotFoundError:
            pass
        except BROKEN as error:
            broken = True
            log.warning("broken cache entry %s is made again: %s", entry, error)
        return self._compile(house_id, entry, broken)

    def notes(self, house_id: str) -> Notes:
        """What of a compiled house is no array, such as `instances.model`; it is compiled if need be."""
        try:
            return read_notes(self.entry(house_id))
        except BROKEN:
            return flatten(self.load(house_id), frozenset(("models",)))[1]

    def contents(self, house_id: str) -> HouseContents:
        """What a filter asks about a house; it is compiled if need be, but no model is read.

        Raises:
            DatasetError: The house is unknown or broken.
        """
        self.dataset.check_known(house_id)
        try:
            arrays, notes = read_entry(self.entry(house_id))
            return contents_of(notes["report"], rebuild(Rooms, arrays, notes, "rooms."), arrays["semantics"])
        except BROKEN:
            house = self.load(house_id)
            return contents_of(house.report, house.rooms, house.semantics)

    def textures(self, notes: Notes) -> list[str]:
        """Paths of the images that a house shows, from its notes."""
        return [self._absolute(path) for path in notes["materials.texture"]]

    def model(self, key: str) -> Model:
        """A library model that a compiled house names; raises as `entry.read_entry`."""
        return self._models((key,))[key]

    def _models(self, keys: Iterable[str]) -> dict[str, Model]:
        keys = dict.fromkeys(keys)
        fresh = {key: rebuild(Model, *read_entry(self._model_path(key))) for key in keys if key not in self.library}
        check_models(fresh)
        self.library |= fresh
        return {key: self.library[key] for key in keys}

    def entry(self, house_id: str) -> Path:
        """Where the house is in the cache, or would be."""
        named = repr((house_id, self.options, self.dataset.fallbacks))
        self.dataset.prepare((house_id,))
        key = hashlib.sha256(named.encode() + self._inputs.house(house_id)).hexdigest()
        return self._folder / "houses" / f"{key}{SUFFIX}"

    def _read(self, house_id: str, entry: Path) -> CompiledHouse:
        """Raises `FileNotFoundError` if there is no entry, or an image that it shows or lacks is not as it was."""
        arrays, notes = read_entry(entry)
        textures = {self._absolute(path): digest for path, digest in notes.pop("textures").items()}
        if any(self._inputs.texture(path) != digest for path, digest in textures.items()):
            raise FileNotFoundError(entry)
        stand_ins = tuple(StandIn(**item) for item in notes.pop("stand_ins"))
        if any(item.kind == "texture" and self._inputs.has_texture(item.name) for item in stand_ins):
            raise FileNotFoundError(entry)  # what else has arrived gives another key
        models = self._models(notes["instances.model"])
        house = rebuild(CompiledHouse, arrays, notes, models=models)
        check_house(house, house_id)
        self.stand_ins[house_id] = stand_ins
        self.dataset.warn_fallbacks(house_id, stand_ins)
        texture = tuple(map(self._absolute, house.materials.texture))
        return replace(house, materials=replace(house.materials, texture=texture))

    def _compile(self, house_id: str, entry: Path, broken: bool) -> CompiledHouse:
        house = self.dataset.load_house(house_id, self.options.read)
        compiled = compile_house(house, self.dataset.metadata_for(self.options.read), self.options)
        self.compiled += 1
        self.stand_ins[house_id] = house.stand_ins
        try:
            self.unwritten = None
            self._write(compiled, house.stand_ins, entry, broken)
        except OSError as error:
            self.unwritten = error
            log.warning("compiled house is not cached: %s", error)
        models = {key: self.library.setdefault(key, model) for key, model in compiled.models.items()}
        return replace(compiled, models=models)

    def _write(self, house: CompiledHouse, stand_ins: Sequence[StandIn], entry: Path, broken: bool) -> None:
        """Writes those of the house's models that are not there yet, or all to mend what is broken; then the house."""
        claim(self._folder)
        for key, model in house.models.items():
            path = self._model_path(key)
            if broken or not path.is_file():
                write_entry(path, *flatten(model))
        arrays, notes = flatten(house, skip=frozenset(("models",)))
        paths = house.materials.texture
        notes["materials.texture"] = [self._relative(path) for path in paths]
        notes["textures"] = {self._relative(path): self._inputs.texture(path) for path in sorted(set(paths)) if path}
        notes["stand_ins"] = [asdict(item) for item in stand_ins]
        write_entry(entry, arrays, notes)

    def _relative(self, path: str) -> str:
        """A texture's path as it is kept: datasets may move."""
        root = self.dataset.root
        return str(Path(path).relative_to(root)) if path and Path(path).is_relative_to(root) else path

    def _absolute(self, path: str) -> str:
        plain = path[:1] != "/" and ".." not in path and "\\" not in path  # what can lead nowhere else
        if not plain and below(self.dataset.root, self.dataset.root, path) is None:
            raise ValueError(f"a texture lies outside of the dataset: {path!s:.80}")
        return os.path.join(self._root, path) if path else ""

    def _model_path(self, key: str) -> Path:
        return self._folder / "models" / f"{hashlib.sha256(key.encode()).hexdigest()}{SUFFIX}"


def load_compiled(
    dataset: Dataset,
    house_id: str,
    options: CompileOptions = DEFAULT_OPTIONS,
    library: dict[str, Model] | None = None,
) -> CompiledHouse:
    """One compiled house; for several, `HouseCache` looks at what they share once.

    Args:
        dataset: An open dataset.
        house_id: Which house.
        options: How to compile it.
        library: Models by key that other houses have brought; new ones are added, so that houses share them.

    Raises:
        DatasetError: The house is unknown or broken.
    """
    return HouseCache(dataset, options, library).load(house_id)
