"""Options and loading that several subcommands share: which dataset, which house."""

import argparse
from pathlib import Path

from home_mjx.core.paths import dataset_root
from home_mjx.datasets.suncg.dataset import Dataset, open_dataset
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.house import House, Metadata


def add_dataset_option(parser: argparse.ArgumentParser) -> None:
    """Adds `--suncg ROOT`."""
    parser.add_argument(
        "--suncg",
        type=Path,
        default=dataset_root(),
        metavar="ROOT",
        help="root of a SUNCG dataset (default: $SUNCG_DATA_DIR, or generated houses)",
    )


def add_house_arguments(
    parser: argparse.ArgumentParser, text: str = "id of the house (default: the dataset's first)"
) -> None:
    """Adds `HOUSE`, explained by `text`, and `--suncg ROOT`."""
    parser.add_argument("house", nargs="?", metavar="HOUSE", help=text)
    add_dataset_option(parser)


def load_house(args: argparse.Namespace) -> tuple[House, Metadata]:
    """The house that the arguments name, as the dataset has it.

    Raises:
        DatasetError: If the dataset cannot be read or has no such house.
        ConfigError: If they name a whole dataset.
    """
    if names_root(args):
        hint = f"Name one of its houses: HOUSE --suncg {args.house}"
        raise ConfigError(f"expected the id of a house, got the root of a dataset `{args.house}`", hint=hint)
    dataset = open_named_dataset(args)
    return dataset.load_house(args.house or dataset.house_ids[0]), dataset.metadata


def open_named_dataset(args: argparse.Namespace) -> Dataset:
    """The dataset that the arguments name, by default one of generated houses."""
    return open_dataset(named_root(args))


def named_root(args: argparse.Namespace) -> Path:
    """Root of the dataset that the arguments name, by default one of generated houses."""
    return Path(args.house) if names_root(args) else args.suncg or _generated_root()


def names_root(args: argparse.Namespace) -> bool:
    """Whether `HOUSE` is the root of a dataset: a path or a folder, if it is no house of `--suncg`."""
    name = args.house
    if name is None or Path(name).name != name:
        return name is not None
    known = args.suncg is not None and (args.suncg / "house" / name / "house.json").exists()
    return Path(name).is_dir() and not known


def compile_named_house(args: argparse.Namespace) -> CompiledHouse:
    """The house that the arguments name, compiled."""
    from home_mjx.scene_compile.pipeline.compile import compile_house

    return compile_house(*load_house(args))


def _generated_root() -> Path:
    from home_mjx.datasets.procedural.default_houses import generated_houses

    root, _ = generated_houses(1)
    return root
