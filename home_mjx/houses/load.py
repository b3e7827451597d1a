"""From whatever names houses to a bank: dataset, cache, bank, bakes."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.texture_layers import TEXTURE_SIZE
from home_mjx.core.checks import check_number
from home_mjx.core.paths import dataset_root
from home_mjx.core.progress import plural, say
from home_mjx.datasets.base import Dataset
from home_mjx.errors import ConfigError
from home_mjx.houses.bakes import Bake, add_bakes
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.selection import HouseFilter
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions

DEFAULT_DATASET = "procedural:65536"  # where no dataset is named and `SUNCG_DATA_DIR` is not set
NUM_HOUSES = 8  # of the default dataset

Houses = HouseBank | HouseSet | Dataset | str | Path | None


def load_bank(
    houses: HouseSet | Dataset | str | Path | None = None,
    *,
    ids: Sequence[str] | None = None,
    num_houses: int | None = None,
    split: str | None = None,
    filter: HouseFilter | None = None,
    options: CompileOptions = DEFAULT_OPTIONS,
    progress: bool | None = None,
    bakes: Sequence[Bake | str] = (),
    texture_size: int = TEXTURE_SIZE,
) -> HouseBank:
    """Load houses onto the device; those that are not in the cache are compiled first.

    Args:
        houses: Folder of a dataset, an open one, a name such as `procedural:16`, or a `HouseSet`; None: the dataset
            that `SUNCG_DATA_DIR` names, or else generated houses.
        ids: Ids of the houses, in this order; None: all.
        num_houses: Maximum number of houses; None: all, or 8 generated ones.
        split: Only houses of `train`, `val` or `test`.
        filter: Only houses that pass this filter.
        options: Compile options; ignored for a `HouseSet` with options other than the default. The four choices above
            are not allowed beside a `HouseSet`.
        progress: Show what happens, on stderr; None: by the rule of `home_mjx.core.progress`.
        bakes: Baked records that the bank gets, or their names; see `add_bakes`.
        texture_size: Edge of the textures [px], a power of two: 128 for small images, 512 for pictures to look at.

    Raises:
        DatasetError: The dataset or one of the houses is missing or broken.
        ConfigError: No house is left, the houses cannot share a bank, or `texture_size` is no power of two. A choice is
            invalid or beside a `HouseSet`, `filter` is given without a dataset, or a value of `bakes` is not a bake.
        UnknownNameError: No bake has this name.

    Example:
        >>> bank = load_bank("procedural:2")  # doctest: +SKIP
        >>> bank.num_houses  # doctest: +SKIP
        2
    """
    chosen = house_set(houses, ids=ids, num_houses=num_houses, split=split, filter=filter, options=options)
    compiled = chosen.load(progress)
    say(f"moving {plural(len(compiled), 'house')} to the device", progress)
    bank = HouseBank.from_compiled(compiled, texture_size)
    return add_bakes(bank, compiled, bakes, progress) if bakes else bank


def house_set(
    houses: HouseSet | Dataset | str | Path | None,
    *,
    ids: Sequence[str] | None = None,
    num_houses: int | None = None,
    split: str | None = None,
    filter: HouseFilter | None = None,
    options: CompileOptions = DEFAULT_OPTIONS,
) -> HouseSet:
    """Return the `HouseSet` that `load_bank` loads, without compiling it; arguments as there.

    Raises:
        ConfigError: A choice is invalid or made twice, or `filter` is given without a dataset.
    """
    if num_houses is not None:
        check_number("num_houses", num_houses, 1, integer=True)
    if isinstance(houses, HouseSet):
        chosen = HouseSet.coerce(houses, ids=ids, num_houses=num_houses, split=split, filter=filter)
        return replace(chosen, options=options) if chosen.options == DEFAULT_OPTIONS else chosen
    if houses is None and dataset_root() is None:
        if filter is not None:
            hint = "Write some with `home-mjx generate OUT`, then pass houses=OUT."
            raise ConfigError("`filter` chooses among the houses of a dataset", hint=hint)
        houses, num_houses = DEFAULT_DATASET, num_houses or (NUM_HOUSES if ids is None else None)
    return HouseSet(houses, ids=ids, num_houses=num_houses, split=split, filter=filter, options=options)
