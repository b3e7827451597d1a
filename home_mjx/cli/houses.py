"""Options and loading that several subcommands share: which dataset, which house."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from home_mjx.cli.parsing import file_path, natural
from home_mjx.core.paths import dataset_root
from home_mjx.errors import ConfigError

DEFAULT_DATASET = "procedural:1"  # where no dataset is named

if TYPE_CHECKING:
    from home_mjx.datasets.base import Dataset
    from home_mjx.datasets.options import ReadOptions
    from home_mjx.houses.house_set import HouseSet
    from home_mjx.scene_compile.pipeline.compile import CompileOptions
    from home_mjx.schema.compiled import CompiledHouse
    from home_mjx.schema.house import House, Metadata


def add_dataset_option(parser: argparse.ArgumentParser) -> None:
    """Adds `--dataset ROOT`, and its old name `--suncg`."""
    parser.add_argument(
        "--dataset",
        type=file_path,
        default=dataset_root(),
        metavar="ROOT",
        help="root of a dataset in SUNCG's format (default: $SUNCG_DATA_DIR, or generated houses)",
    )
    parser.add_argument("--suncg", dest="dataset", type=file_path, default=argparse.SUPPRESS, help=argparse.SUPPRESS)


def add_house_arguments(
    parser: argparse.ArgumentParser, text: str = "id of the house (default: the dataset's first)"
) -> None:
    """Adds `HOUSE`, explained by `text`, and `--dataset ROOT`."""
    parser.add_argument("house", nargs="?", metavar="HOUSE", help=text)
    add_dataset_option(parser)


def add_strict_option(parser: argparse.ArgumentParser) -> None:
    """Adds `--strict`."""
    parser.add_argument(
        "--strict", action="store_true", help="refuse a house that lacks a file, instead of taking stand-ins"
    )


def read_options(args: argparse.Namespace) -> "ReadOptions":
    """How houses are read: strictly if `--strict` is given, else as suits the dataset."""
    from home_mjx.datasets.options import ReadOptions

    return ReadOptions(strict=True if getattr(args, "strict", False) else None)


def add_movable_option(parser: argparse.ArgumentParser) -> None:
    """Adds `--max-bodies N`."""
    parser.add_argument(
        "--max-bodies", type=natural, metavar="N", help="most objects of a house that can be moved (default: 32)"
    )


def compile_options(args: argparse.Namespace) -> "CompileOptions":
    """How houses are compiled, by `--strict` and `--max-bodies` of commands that have them."""
    from home_mjx.scene_compile.collision.movables import MovableOptions
    from home_mjx.scene_compile.pipeline.compile import CompileOptions

    most = getattr(args, "max_bodies", None)
    movables = MovableOptions() if most is None else MovableOptions(max_bodies=most)
    return CompileOptions(read=read_options(args), movables=movables)


def named_root(args: argparse.Namespace) -> str | Path:
    """Return the folder or name of the dataset that the arguments name, by default of one generated house."""
    if names_root(args):
        return args.house
    return args.dataset or DEFAULT_DATASET


def names_root(args: argparse.Namespace) -> bool:
    """Whether `HOUSE` is the root of a dataset: a path or a folder, if it is no house of `--dataset`."""
    name = args.house
    if name is None or Path(name).name != name:
        return name is not None
    known = args.dataset is not None and (args.dataset / "house" / name / "house.json").exists()
    return Path(name).is_dir() and not known


def open_named_dataset(args: argparse.Namespace) -> "Dataset":
    """The dataset that the arguments name, by default one of generated houses."""
    from home_mjx.datasets.registry import open_dataset

    return open_dataset(named_root(args))


def named_houses(args: argparse.Namespace) -> "HouseSet":
    """All houses of the dataset that the arguments name, or the one house."""
    from home_mjx.houses.house_set import HouseSet

    ids = None if args.house is None or names_root(args) else (str(args.house),)
    return HouseSet(open_named_dataset(args), ids, options=compile_options(args))


def named_house(args: argparse.Namespace) -> tuple["Dataset", str]:
    """The dataset, and the id of the house that the arguments name, by default its first.

    Raises:
        DatasetError: If the dataset cannot be read.
        ConfigError: If they name a whole dataset.
    """
    if names_root(args):
        hint = f"Name one of its houses: HOUSE --dataset {args.house}"
        raise ConfigError(f"expected the id of a house, got the root of a dataset `{args.house}`", hint=hint)
    dataset = open_named_dataset(args)
    house_id = args.house or dataset.house_ids[0]
    if args.house is None:
        dataset.prepare((house_id,))
    return dataset, house_id


def load_house(args: argparse.Namespace) -> tuple["House", "Metadata"]:
    """The house that the arguments name, as the dataset has it; errors as of `named_house`."""
    dataset, house_id = named_house(args)
    options = read_options(args)
    return dataset.load_house(house_id, options), dataset.metadata_for(options)


def load_compiled_house(args: argparse.Namespace) -> "CompiledHouse":
    """The house that the arguments name, compiled, from the cache if it is there; errors as of `named_house`."""
    from home_mjx.houses.house_cache import load_compiled

    return load_compiled(*named_house(args), options=compile_options(args))
