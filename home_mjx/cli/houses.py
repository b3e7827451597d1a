"""Shared options and loading of subcommands: the dataset and the house."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from home_mjx.cli.parsing import parse_dataset, parse_natural
from home_mjx.core.paths import dataset_root
from home_mjx.core.progress import is_progress_shown
from home_mjx.errors import ConfigError

DEFAULT_DATASET = "procedural:1"  # where no dataset is named

if TYPE_CHECKING:
    from home_mjx.datasets.base import Dataset, ReadOptions
    from home_mjx.houses.house_set import HouseSet
    from home_mjx.scene_compile.pipeline.compile import CompileOptions
    from home_mjx.schema.compiled import CompiledHouse
    from home_mjx.schema.house import House, Metadata


def add_dataset_option(parser: argparse.ArgumentParser) -> None:
    """Add `--dataset ROOT`, a path or a text `scheme:...`, and its hidden old name `--suncg`; see `parse_dataset`.

    The default is `dataset_root()`, which may be None.
    """
    parser.add_argument(
        "--dataset",
        type=parse_dataset,
        default=dataset_root(),
        metavar="ROOT",
        help="folder of a dataset, or its name such as procedural:16 (default: $SUNCG_DATA_DIR, or generated houses)",
    )
    parser.add_argument(
        "--suncg", dest="dataset", type=parse_dataset, default=argparse.SUPPRESS, help=argparse.SUPPRESS
    )


def add_house_arguments(
    parser: argparse.ArgumentParser, text: str = "id of the house (default: the dataset's first)"
) -> None:
    """Add the optional positional `HOUSE` (`house`, None by default) with help `text`, and `--dataset ROOT`."""
    parser.add_argument("house", nargs="?", metavar="HOUSE", help=text)
    add_dataset_option(parser)


def add_strict_option(parser: argparse.ArgumentParser) -> None:
    """Add the flag `--strict` (`strict`, False): reject a house with missing files, instead of using fallbacks."""
    parser.add_argument(
        "--strict", action="store_true", help="reject a house with missing files, instead of using fallbacks"
    )


def read_options(args: argparse.Namespace) -> "ReadOptions":
    """Return the read options: strict with `--strict`, else the dataset's default."""
    from home_mjx.datasets.base import ReadOptions

    return ReadOptions(strict=True if getattr(args, "strict", False) else None)


def add_movable_option(parser: argparse.ArgumentParser) -> None:
    """Add `--max-bodies N` and `--max-fronts N`.

    They are the maximum numbers of movable objects and of fronts of furniture that open, per house and from 0; None by
    default, which is 32 and 0.
    """
    parser.add_argument(
        "--max-bodies",
        type=parse_natural,
        metavar="N",
        help="maximum number of movable objects per house (default: 32)",
    )
    parser.add_argument(
        "--max-fronts",
        type=parse_natural,
        metavar="N",
        help="maximum number of fronts of furniture per house that open, the largest ones (default: 0)",
    )


def compile_options(args: argparse.Namespace) -> "CompileOptions":
    """Return the compile options from `--strict`, `--max-bodies` and `--max-fronts`; defaults for other commands."""
    from home_mjx.scene_compile.collision.movables import MovableOptions
    from home_mjx.scene_compile.objects.fronts import ArticulationOptions
    from home_mjx.scene_compile.pipeline.compile import CompileOptions

    most = getattr(args, "max_bodies", None)
    movables = MovableOptions() if most is None else MovableOptions(max_bodies=most)
    articulation = ArticulationOptions(getattr(args, "max_fronts", None) or 0)
    return CompileOptions(read=read_options(args), movables=movables, articulation=articulation)


def selected_root(args: argparse.Namespace) -> str | Path:
    """Return the folder or name of the dataset as text.

    It is `HOUSE` if that is a dataset (see `is_dataset_root`), else `--dataset`, else `DEFAULT_DATASET`.
    """
    if is_dataset_root(args):
        return args.house
    return str(args.dataset or DEFAULT_DATASET)


def is_dataset_name(args: argparse.Namespace) -> bool:
    """Return whether `HOUSE` is the name of a dataset, such as `procedural:1?seed=40`; False for None."""
    from home_mjx.datasets.registry import has_scheme

    return has_scheme(args.house)


def is_dataset_root(args: argparse.Namespace) -> bool:
    """Return whether `HOUSE` is a dataset; False for None.

    It is if it is a name with a scheme, any path with `/` (which need not exist), `.`, or a folder that is no house of
    `--dataset`.
    """
    from home_mjx.datasets.registry import has_scheme

    name = args.house
    if name is None or Path(name).name != name or has_scheme(name):
        return name is not None
    known = args.dataset is not None and (Path(args.dataset) / "house" / name / "house.json").exists()
    return Path(name).is_dir() and not known


def open_selected_dataset(args: argparse.Namespace) -> "Dataset":
    """Open the dataset of `selected_root`; errors as in `open_dataset`."""
    from home_mjx.datasets.registry import open_dataset

    return open_dataset(selected_root(args))


def selected_houses(args: argparse.Namespace) -> "HouseSet":
    """Return a `HouseSet` of the selected house, or of all houses if `HOUSE` is absent or a dataset.

    Its compile options are those of the arguments. Errors are those of `open_dataset`; houses are read later, and a
    given id is not checked.
    """
    from home_mjx.houses.house_set import HouseSet

    ids = None if args.house is None or is_dataset_root(args) else (str(args.house),)
    return HouseSet(open_selected_dataset(args), ids, options=compile_options(args))


def selected_house(args: argparse.Namespace) -> tuple["Dataset", str]:
    """Return the dataset and the id of the selected house, by default the dataset's first.

    A name such as `procedural:1?seed=40` selects the first of its houses. A given id is not checked.

    Raises:
        DatasetError: The dataset cannot be read.
        ConfigError: The arguments select the folder of a whole dataset.
    """
    is_root, is_named = is_dataset_root(args), is_dataset_name(args)
    if is_root and not is_named:
        hint = f"Pass one of its houses: HOUSE --dataset {args.house}"
        raise ConfigError(f"expected the id of a house, got the root of a dataset `{args.house}`", hint=hint)
    dataset = open_selected_dataset(args)
    return dataset, dataset.house_ids[0] if args.house is None or is_named else args.house


def load_house(args: argparse.Namespace) -> tuple["House", "Metadata"]:
    """Load the selected house, not compiled, and its dataset's metadata.

    Errors are those of `selected_house`, and `DatasetError` if the house is unknown or broken.
    """
    dataset, house_id = selected_house(args)
    dataset.prepare((house_id,), is_progress_shown())
    options = read_options(args)
    return dataset.load_house(house_id, options), dataset.metadata_for(options)


def load_compiled_house(args: argparse.Namespace) -> "CompiledHouse":
    """Load the selected house compiled, from the cache if possible; a house compiled now is added to it.

    Errors are those of `selected_house`, and `DatasetError` if the house is unknown or broken.
    """
    from home_mjx.houses.house_cache import load_compiled

    return load_compiled(*selected_house(args), options=compile_options(args))
