"""Write one house as a glTF file or as a Habitat dataset."""

import argparse
import sys

from home_mjx.cli.houses import add_house_arguments, add_movable_option, add_strict_option, load_compiled_house
from home_mjx.cli.parsing import parse_path

FORMATS = ("glb", "habitat")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `HOUSE`, `OUT`, and the options `--format`, `--dataset`, `--strict` and `--max-bodies`."""
    add_house_arguments(parser, "id of a house")
    parser.add_argument("out", type=parse_path, metavar="OUT", help="file or folder to write, such as house.glb")
    parser.add_argument(
        "--format", choices=FORMATS, default=FORMATS[0], help="a GLB file, or a folder that is a Habitat scene dataset"
    )
    add_strict_option(parser)
    add_movable_option(parser)


def run(args: argparse.Namespace) -> int:
    """Write the selected house and print the path; return 0.

    Raises:
        ConfigError: `OUT` does not end in `.glb`, is no folder, or cannot be written.
        DatasetError: The house or a texture cannot be read.
    """
    from home_mjx.scene_compile.gltf.export import check_name, export_gltf
    from home_mjx.scene_compile.gltf.habitat_export import export_habitat

    if args.format == "glb":
        check_name(args.out)
        path = export_gltf(load_compiled_house(args), args.out)
    else:
        path = export_habitat(load_compiled_house(args), args.out)
    sys.stdout.write(f"{path}\n")
    return 0
