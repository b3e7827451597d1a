"""Environment ids and how to make them."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from home_mjx.core.checks import check_number
from home_mjx.errors import ConfigError, did_you_mean

_REGISTRY: dict[str, Callable[..., Any]] = {}
_ID = re.compile(r"^[A-Z][A-Za-z0-9]*-v\d+$")


def register(env_id: str, entry_point: Callable[..., Any]) -> None:
    """Adds an environment.

    Args:
        env_id: `Name-vN`; raise N whenever learning results could change.
        entry_point: Called as `entry_point(get_bank, **options)`; `get_bank()` gives the `HouseBank`.

    Raises:
        ConfigError: If the id has another form or is taken.
    """
    if not _ID.match(env_id):
        raise ConfigError(f"environment id `{env_id}` is not of the form Name-vN", hint="For example PointNav-v0")
    if env_id in _REGISTRY:
        raise ConfigError(f"environment id `{env_id}` is taken", hint="Raise its version number")
    _REGISTRY[env_id] = entry_point


def list_envs() -> tuple[str, ...]:
    """All environment ids.

    Example:
        >>> list_envs()
        ('PointNav-v0',)
    """
    return tuple(sorted(_REGISTRY))


def make(
    env_id: str,
    houses: Any = None,
    *,
    num_houses: int = 8,
    split: str | None = None,
    where: Any = None,
    progress: bool = False,
    **options: Any,
) -> Any:
    """An environment by id.

    Args:
        env_id: Such as `PointNav-v0`, see `list_envs`.
        houses: A `HouseBank`, the root folder of a SUNCG dataset, or None: then the dataset that the environment
            variable `SUNCG_DATA_DIR` names, or, where it is not set, generated houses, made once and kept in the cache
            folder.
        num_houses: How many houses of a dataset or generator to use.
        split: Only houses of `train`, `val` or `test`.
        where: A `HouseFilter`: only houses of a dataset that have all this.
        progress: Show a progress bar while houses are made and compiled.
        **options: Fields of `EnvConfig`, `PhysicsConfig` and `AudioConfig`.

    Returns:
        A `HouseholdEnv`.

    Raises:
        ConfigError: For an unknown id or option, with the closest known one.
        DatasetError: If the dataset cannot be read.

    Example:
        >>> env = make("PointNav-v0", num_houses=4, sensors=("depth", "goal"))  # doctest: +SKIP
    """
    if env_id not in _REGISTRY:
        raise ConfigError(f"unknown environment `{env_id}`", hint=did_you_mean(env_id, _REGISTRY))
    return _REGISTRY[env_id](lambda: as_bank(houses, num_houses, progress, split, where), **options)


def as_bank(
    houses: Any, num_houses: int = 8, progress: bool = False, split: str | None = None, where: Any = None
) -> Any:
    """A `HouseBank` from what `make` takes as `houses`.

    Raises:
        ConfigError: A selection was asked for of houses that are already a bank, or a filter of generated ones.
    """
    from home_mjx.bank.bank import HouseBank
    from home_mjx.core.paths import dataset_root
    from home_mjx.datasets.procedural.default_houses import generated_houses
    from home_mjx.datasets.suncg.dataset import Dataset

    if isinstance(houses, HouseBank):
        if split is not None or where is not None:
            raise ConfigError("`split` and `where` choose houses of a dataset, not of a bank that is made")
        return houses
    check_number("num_houses", num_houses, 1, whole=True)
    houses = houses or dataset_root()
    if houses is not None and not isinstance(houses, str | Path | Dataset):
        raise ConfigError(f"`houses` must be a HouseBank or the folder of a dataset, got {houses!r}")
    if houses is not None:
        root = houses if isinstance(houses, Dataset) else Path(houses)
        return HouseBank.from_dataset(root, num_houses=num_houses, progress=progress, split=split, where=where)
    if where is not None:
        hint = "Write some with `home-mjx generate OUT`, then pass houses=OUT."
        raise ConfigError("`where` chooses among the houses of a dataset", hint=hint)
    root, ids = generated_houses(num_houses, progress, split)
    return HouseBank.from_dataset(root, ids=ids, progress=progress)


def _point_nav(get_bank: Callable[[], Any], **options: Any) -> Any:
    from home_mjx.tasks.base.config import make_config
    from home_mjx.tasks.environment.household import HouseholdEnv

    config = make_config(**options)  # refuse a wrong option before any house is compiled
    return HouseholdEnv(get_bank(), config)


register("PointNav-v0", _point_nav)
