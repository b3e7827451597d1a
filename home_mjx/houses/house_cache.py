"""On-disk cache of compiled houses, addressed by a hash of their inputs.

The cache folder has one folder per version of the format and the compiler, with subfolders `houses/` and `models/`,
since houses share most models. Entries are written atomically and verified by their CRCs, see `entry_path`.
"""

import hashlib
import logging
import os
import weakref
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from functools import cached_property
from pathlib import Path

from home_mjx.core.array_store import (
    ENTRY_SUFFIX,
    READ_ERRORS,
    Arrays,
    JsonFields,
    flatten,
    read_entry,
    read_notes,
    rebuild,
    write_entry,
)
from home_mjx.core.files import resolve_below
from home_mjx.core.progress import say
from home_mjx.datasets.base import Dataset
from home_mjx.datasets.furniture import attach_joints, hash_joints
from home_mjx.datasets.kept_results import ResultStore, keep_results
from home_mjx.errors import DatasetError
from home_mjx.houses.integrity import check_house, check_models
from home_mjx.houses.selection import HouseContents, summarize_contents
from home_mjx.houses.shipped import ShippedHouse, open_shipped
from home_mjx.houses.version import create_version_folder, mark_used, version_folder
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions, compile_house
from home_mjx.schema.compiled import CompiledHouse, Model, RoomTable
from home_mjx.schema.house import Fallback

HOUSES, MODELS = "houses", "models"  # subfolders of a version folder
log = logging.getLogger(__name__)


class HouseCache:
    """Compiled houses of one dataset, loaded from disk unless one of their inputs has changed.

    Inputs that houses share, such as model files, are checked once; create a new cache to detect later changes. Files
    are read only if their size or times indicate a change, see `datasets.suncg.digest_index`.

    Args:
        dataset: An open dataset.
        options: Compile options of its houses.
        library: Models by key, shared with other caches; new models are added.

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
        self.on_compile: Callable[[], object] | None = None  # called before a house is compiled
        self.num_compiled = 0  # number of houses that were not in the cache
        self.write_error: OSError | None = None  # error of the last write; None if it succeeded
        self.fallbacks: dict[str, tuple[Fallback, ...]] = {}  # by id of loaded house
        self._root = str(dataset.root)
        self._inputs = dataset.inputs()
        weakref.finalize(self, self._inputs.save)
        self._shipped = open_shipped(dataset.shipped)
        self._folder = version_folder()
        mark_used(self._folder)

    def prepare(self, house_ids: Sequence[str], progress: bool = False) -> None:
        """Make the files of houses available, see `Dataset.prepare`; of shipped houses only the textures.

        Raises:
            DatasetError: The files cannot be written.
        """
        rows = {house_id: self._shipped_row(house_id) for house_id in house_ids}
        paths = [path for row in rows.values() if row is not None for path in row.textures]
        if paths:
            self._shipped.write_textures(paths, progress)
        self.dataset.prepare([house_id for house_id, row in rows.items() if row is None], progress)

    def missing(self, house_ids: Sequence[str]) -> list[str]:
        """Return those houses, each once, that are neither cached nor shipped; unknown and broken ones are omitted."""
        found = []
        for house_id in dict.fromkeys(house_ids):
            with suppress(DatasetError):
                if self._shipped_row(house_id) is None and not self.entry_path(house_id).is_file():
                    found.append(house_id)
        return found

    def load(self, house_id: str) -> CompiledHouse:
        """Return a compiled house and record its fallbacks; compile it if it is not cached or an input has changed.

        A shipped house is copied into the cache instead. A corrupted entry is compiled and written again. If the folder
        is not writable, each run compiles the house.

        Raises:
            DatasetError: The house is unknown or broken.
        """
        self.dataset.check_known(house_id)
        row = self._shipped_row(house_id)
        if row is not None:
            self._shipped.write_textures(row.textures)
        entry = self.entry_path(house_id)
        broken = False
        try:
            return self._read(house_id, entry)
        except FileNotFoundError:
            pass
        except READ_ERRORS as error:
            broken = True
            log.warning("broken cache entry %s is compiled again: %s", entry, error)
        if row is not None:
            house = self._unpack(row, entry, broken)
            if house is not None:
                return house
            entry = self.entry_path(house_id)
        return self._compile(house_id, entry, broken)

    def notes(self, house_id: str) -> JsonFields:
        """Return a compiled house's values that are not arrays, by dotted name; `load` it if it is not cached.

        Paths of textures are relative to the dataset if the house was cached, else absolute; see `texture_paths`.

        Raises:
            DatasetError: The house is unknown or broken.
        """
        try:
            return read_notes(self.entry_path(house_id))
        except READ_ERRORS:
            return flatten(self.load(house_id), frozenset(("models",)))[1]

    def contents(self, house_id: str) -> HouseContents:
        """Return the properties of a house that a `HouseFilter` uses; compile it if necessary, without reading models.

        Raises:
            DatasetError: The house is unknown or broken.
        """
        self.dataset.check_known(house_id)
        try:
            arrays, notes = read_entry(self.entry_path(house_id))
            return summarize_contents(notes["report"], rebuild(RoomTable, arrays, notes, "rooms."), arrays["semantics"])
        except READ_ERRORS:
            house = self.load(house_id)
            return summarize_contents(house.report, house.rooms, house.semantics)

    def texture_paths(self, notes: JsonFields) -> list[str]:
        """Return the absolute path of the texture of each of a house's materials, from its notes; "" for none.

        Raises:
            ValueError: A texture is outside the dataset.
        """
        return [self._absolute(path) for path in notes["materials.texture"]]

    def model(self, key: str) -> Model:
        """Return the model with a key, read once into `library`; one of `READ_ERRORS` if missing or corrupted."""
        return self._models((key,))[key]

    def _find_model(self, key: str) -> Model | None:
        """Return the model with a key; None if it is not cached, or if its entry is corrupted, and thus removed."""
        try:
            return self.model(key)
        except FileNotFoundError:
            return None
        except READ_ERRORS as error:
            log.warning("broken cache entry %s is built again: %s", self.model_path(key), error)
            with suppress(OSError):
                self.model_path(key).unlink()
            return None

    def _models(self, keys: Iterable[str]) -> dict[str, Model]:
        """Return models by key, each read and validated once into `library`; one of `READ_ERRORS` if that fails.

        Then none of the models that were read is added to `library`.
        """
        keys = dict.fromkeys(keys)
        fresh = {key: rebuild(Model, *read_entry(self.model_path(key))) for key in keys if key not in self.library}
        check_models(fresh)
        self.library |= fresh
        return {key: self.library[key] for key in keys}

    def entry_path(self, house_id: str) -> Path:
        """Return the path of the house's cache entry, whether or not it exists.

        The file name is a digest of the id, the options, the reader, the fallbacks and the dataset's files.
        Prepare these files first, unless the house is shipped.

        Raises:
            DatasetError: The files cannot be written, see `Dataset.prepare`.
        """
        key = self.entry_name(house_id, self._shipped.inputs)
        if key not in self._shipped.houses:
            self.dataset.prepare((house_id,))
            key = self.entry_name(house_id, self._inputs.house(house_id) + self._joints_digest)
        return self._folder / HOUSES / f"{key}{ENTRY_SUFFIX}"

    @cached_property
    def _joints_digest(self) -> bytes:
        """Digest of the dataset's table of joints; empty if furniture is rigid."""
        return hash_joints(self.dataset.joints) if self.options.articulation.max_fronts else b""

    def entry_name(self, house_id: str, inputs: bytes) -> str:
        """Return the name of the house's entry, a hexadecimal digest, if its files have the digest `inputs`.

        It has no suffix. The entry need not exist.
        """
        named = repr((house_id, self.options, self.dataset.fallbacks, self.dataset.reader))
        return hashlib.sha256(named.encode() + inputs).hexdigest()

    def _shipped_row(self, house_id: str) -> ShippedHouse | None:
        """Return the archive's row of a house; None if it is not shipped with these options, or was found damaged."""
        return self._shipped.houses.get(self.entry_name(house_id, self._shipped.inputs))

    def _unpack(self, row: ShippedHouse, entry: Path, broken: bool) -> CompiledHouse | None:
        """Return a shipped house and copy it and its bakes into the cache; a failed copy is logged.

        None, after a warning, if the archive is damaged; the house then no longer counts as shipped. If `broken`, its
        models in the cache are not read, but written again.
        """
        try:
            arrays, notes = self._shipped.read(f"{HOUSES}/{entry.name}")
            fresh = {key: self._unpack_model(key, broken) for key in row.models if key not in self.library}
            check_models(fresh)
            self.library |= fresh
            house = self._assemble(row.id, arrays, dict(notes))
        except READ_ERRORS as error:
            log.warning("shipped house %s is damaged, it is compiled instead: %s", row.id, error)
            del self._shipped.houses[entry.stem]
            return None
        try:
            self.write_error = None
            create_version_folder(self._folder)
            self._shipped.unpack_bakes(row)
            write_entry(entry, arrays, notes)
        except READ_ERRORS as error:
            self.write_error = error if isinstance(error, OSError) else None
            log.warning("shipped house %s is not copied into the cache: %s", row.id, error)
        return house

    def _unpack_model(self, key: str, broken: bool) -> Model:
        """Return a model of a shipped house from the cache; without one, or if `broken`, from the archive.

        It is then written into the cache; a failed write is ignored. Models that the archive lacks are built from the
        source's library.

        Raises:
            Exception: The model is corrupted or missing; one of `READ_ERRORS`.
        """
        path = self.model_path(key)
        with suppress(FileNotFoundError):
            if not broken:
                return rebuild(Model, *read_entry(path))
        member = f"{MODELS}/{path.name}"
        if self._shipped.has(member):
            model = rebuild(Model, *self._shipped.read(member))
        else:
            model = self._shipped.library_model(key)
        if model is None or model.key != key:
            raise ValueError(f"model {key} is missing")
        with suppress(OSError):  # a folder that cannot be written to is reported when the house is written
            write_entry(path, *flatten(model))
        return model

    def _read(self, house_id: str, entry: Path) -> CompiledHouse:
        """Return a house with its models from its entry; validate them, record the fallbacks and warn of them.

        Raises:
            Exception: The entry is corrupted or invalid; one of `READ_ERRORS`.
            FileNotFoundError: There is no entry, a used texture has changed, or a missing one has been added.
        """
        return self._assemble(house_id, *read_entry(entry))

    def _assemble(self, house_id: str, arrays: Arrays, notes: JsonFields) -> CompiledHouse:
        """Return a house of the arrays and notes of its entry; errors as of `_read`.

        Two entries of `notes`, `texture_paths` and `fallbacks`, are removed. Paths of textures become absolute.
        """
        textures = {self._absolute(path): digest for path, digest in notes.pop("texture_paths").items()}
        if any(self._inputs.texture(path) != digest for path, digest in textures.items()):
            raise FileNotFoundError(house_id)
        fallbacks = tuple(Fallback(**item) for item in notes.pop("fallbacks"))
        if any(item.kind == "texture" and self._inputs.has_texture(item.name) for item in fallbacks):
            raise FileNotFoundError(house_id)  # other added files change the key
        models = self._models(notes["instances.model"])
        house = rebuild(CompiledHouse, arrays, notes, models=models)
        check_house(house, house_id)
        self.fallbacks[house_id] = fallbacks
        self.dataset.warn_fallbacks(house_id, fallbacks)
        texture = tuple(map(self._absolute, house.materials.texture))
        maps = replace(house.materials.maps, images=tuple(map(self._absolute, house.materials.maps.images)))
        return replace(house, materials=replace(house.materials, texture=texture, maps=maps))

    def _compile(self, house_id: str, entry: Path, broken: bool) -> CompiledHouse:
        """Compile a house, write it to `entry`, and return it; a failed write is logged and set as `write_error`."""
        if self.on_compile is not None:
            self.on_compile()
        with suppress(OSError):  # a folder that cannot be written to is reported when the house is written
            create_version_folder(self._folder)
        with keep_results(ResultStore(self._folder / "results", self._find_model)):
            house = self.dataset.load_house(house_id, self.options.read)
            if self.options.articulation.max_fronts:
                house = attach_joints(house, self.dataset.joints)
            compiled = compile_house(house, self.dataset.metadata_for(self.options.read), self.options)
        self.num_compiled += 1
        self.fallbacks[house_id] = house.fallbacks
        try:
            self.write_error = None
            self._write(compiled, house.fallbacks, entry, broken)
        except OSError as error:
            self.write_error = error
            log.warning("compiled house is not cached: %s", error)
        models = {key: self.library.setdefault(key, model) for key, model in compiled.models.items()}
        return replace(compiled, models=models)

    def _write(self, house: CompiledHouse, fallbacks: Sequence[Fallback], entry: Path, broken: bool) -> None:
        """Write the missing ones of the house's models, or all if its entry was `broken`, and then the house.

        Raises:
            OSError: A file cannot be written.
        """
        create_version_folder(self._folder)
        for key, model in house.models.items():
            path = self.model_path(key)
            if broken or not path.is_file():
                write_entry(path, *flatten(model))
        arrays, notes = flatten(house, skip=frozenset(("models",)))
        paths, images = house.materials.texture, house.materials.maps.images
        notes["materials.texture"] = [self._relative(path) for path in paths]
        notes["materials.maps.images"] = [self._relative(path) for path in images]
        notes["texture_paths"] = {
            self._relative(path): self._inputs.texture(path) for path in sorted({*paths, *images}) if path
        }
        notes["fallbacks"] = [asdict(item) for item in fallbacks]
        write_entry(entry, arrays, notes)

    def _relative(self, path: str) -> str:
        """Return a texture's path relative to the dataset, since datasets may move; other paths are unchanged."""
        root = self.dataset.root
        return str(Path(path).relative_to(root)) if path and Path(path).is_relative_to(root) else path

    def _absolute(self, path: str) -> str:
        """Return the absolute path of a texture, "" unchanged; raise `ValueError` if it is outside the dataset."""
        plain = path[:1] != "/" and ".." not in path and "\\" not in path  # stays below the root
        if not plain and resolve_below(self.dataset.root, self.dataset.root, path) is None:
            raise ValueError(f"texture is outside the dataset: {path!s:.80}")
        return os.path.join(self._root, path) if path else ""

    def model_path(self, key: str) -> Path:
        """Return the path of a model's cache entry, whether or not it exists."""
        return self._folder / MODELS / f"{hashlib.sha256(key.encode()).hexdigest()}{ENTRY_SUFFIX}"


def load_compiled(
    dataset: Dataset,
    house_id: str,
    options: CompileOptions = DEFAULT_OPTIONS,
    library: dict[str, Model] | None = None,
) -> CompiledHouse:
    """Return one compiled house from the cache, or compile it; for several, `HouseCache` checks shared inputs once.

    `library` has models by key, shared with other calls; new models are added.

    Raises:
        DatasetError: The house is unknown or broken.
    """
    cache = HouseCache(dataset, options, library)
    cache.on_compile = lambda: say(f"compiling house {house_id}")
    return cache.load(house_id)
