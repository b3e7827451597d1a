"""Bank of compiled houses on the device: ragged geometry is concatenated, small tables are padded.

An environment stores only an int32 house index.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int, UInt32

from home_mjx.bank.packing.pack import PackedBank, pack_bank
from home_mjx.bank.packing.texture_layers import TEXTURE_SIZE
from home_mjx.bank.records.bank_arrays import RECORDS, BankArrays, group_by_record
from home_mjx.bank.records.geometry import Geometry
from home_mjx.bank.records.gpu_geometry import gpu_geometry
from home_mjx.core.native.fork_guard import record_process
from home_mjx.schema.compiled import CompiledHouse

FINGERPRINT_FACTOR = 16777619  # prime factor of the FNV-1 hash


class HouseBank(BankArrays):
    """Compiled houses packed into one pytree.

    Example:
        >>> bank = home_mjx.load_bank("datasets/demo")  # doctest: +SKIP
        >>> bank.num_houses  # doctest: +SKIP
        8
    """

    @classmethod
    def from_compiled(cls, houses: Sequence[CompiledHouse], texture_size: int = TEXTURE_SIZE) -> "HouseBank":
        """Pack compiled houses into a bank, in the given order.

        Args:
            houses: At least one house; all compiled with the same options.
            texture_size: Edge of the textures [px], a power of two; see `texture_size_for`.

        Raises:
            ConfigError: There is no house, the houses cannot share a bank, an id is not short ASCII, or the size is no
                power of two.
            CapacityError: The houses have too many triangles for one bank.
            DatasetError: A texture cannot be read.
        """
        return to_bank(pack_bank(houses, texture_size))

    @property
    def num_houses(self) -> int:
        """Number of houses."""
        return self.house_id.shape[0]

    @property
    def house_ids(self) -> tuple[str, ...]:
        """Ids of the houses in the dataset, in bank order; computed on the host."""
        return tuple(bytes(row).rstrip(b"\0").decode() for row in np.asarray(self.house_id))

    def _repr_html_(self) -> str:
        """Return counts and the plans of the first houses' lowest storeys, for notebooks."""
        from home_mjx.core.notebook_html import format_houses

        area = np.asarray(self.navigation.num_cells) * self.spec.cell**2  # [m^2]
        objects = (np.asarray(self.geometry.instance_model) >= 0).sum(axis=1)
        return format_houses(self.house_ids, np.asarray(self.navigation.room[:, 0]), objects, area, tuple(self.bakes))

    def clip_house_index(self, house: Int[Array, "*n"] | int) -> Int[Array, "*n"]:
        """Clip house indices to 0..`num_houses` - 1, see `Geometry.clip_house_index`."""
        return self.geometry.clip_house_index(house)

    def fingerprint(self, house: Int[Array, ""] | int) -> UInt32[Array, ""]:
        """Return a 32-bit number by which states identify their house: a hash of id, grid origin, cell counts, goals.

        Houses that differ in any of these have different numbers, up to chance (2^-32); other differences do not count.
        Indices are clipped.
        """
        house, navigation = self.clip_house_index(house), self.navigation
        places = jnp.concatenate([navigation.origin[house], navigation.goal[house].ravel()])
        words = [self.house_id[house].astype(jnp.uint32), jax.lax.bitcast_convert_type(places, jnp.uint32)]
        counts = jnp.stack([navigation.num_cells[house], navigation.num_free_cells[house]])
        words = jnp.concatenate([*words, counts.astype(jnp.uint32)])
        factors = [pow(FINGERPRINT_FACTOR, k + 1, 2**32) for k in range(words.shape[0])]
        return jnp.sum(words * jnp.array(factors, jnp.uint32), dtype=jnp.uint32)

    def semantics_of(self, house: Int[Array, ""] | int, object_id: Int[Array, "*n"], column: int) -> Int[Array, "*n"]:
        """Look up a semantic column for object ids, such as the pixels of an instance image.

        Args:
            house: Index of the house in the bank, clipped.
            object_id: Object ids; agent a has the id `spec.num_instances` + a. All ids from there on count as agents.
            column: One of `schema.semantic.Semantic`; `schema.vocabulary.vocabularies()` has the names of its values.

        Returns:
            Values; -1 for unknown ids, for the id -1 of the architecture, and where an object has no value.

        Example:
            >>> sizes = bank.semantics_of(0, images["instance"], Semantic.SIZE)  # doctest: +SKIP
        """
        rows = self.geometry.object_semantic[self.clip_house_index(house)]
        known = jnp.clip(object_id, 0, rows.shape[0] - 1)
        row = jnp.where(object_id < rows.shape[0], rows[known], self.geometry.agent_semantic)
        found = self.semantics[:, column][jnp.maximum(row, 0)]
        return jnp.where((object_id < 0) | (row < 0), -1, found)


def to_bank(packed: PackedBank) -> HouseBank:
    """Copy packed houses to the default device; resets draw every house equally often, and nothing is baked.

    If the default backend is a GPU, the bank includes `gpu_geometry`.
    """
    record_process()
    # One transfer of all arrays; `jnp.asarray` per array would compile a program for each.
    tables = group_by_record(jax.device_put(packed.arrays, may_alias=False))
    if jax.default_backend() == "gpu":
        tables["geometry"]["gpu"] = gpu_geometry(Geometry(**tables["geometry"]))
    own = tables.pop("")
    draw = jnp.arange(len(own["house_id"]), dtype=jnp.int32)
    return HouseBank(
        **own, **{name: RECORDS[name](**table) for name, table in tables.items()}, reset_houses=draw, spec=packed.spec
    )
