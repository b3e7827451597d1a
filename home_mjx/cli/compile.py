"""Write one house as MJCF with its meshes and textures, to open in MuJoCo's viewer."""

import argparse
import sys
from pathlib import Path

from home_mjx.cli.houses import add_house_arguments, compile_named_house


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx compile`."""
    add_house_arguments(parser)
    parser.add_argument("--out", type=Path, default=Path("mjcf"), help="folder for the files (default: mjcf)")


def run(args: argparse.Namespace) -> int:
    """Writes the MJCF and says how to look at it."""
    from home_mjx.scene_compile.mjcf import export_mjcf

    path = export_mjcf(compile_named_house(args), args.out)
    sys.stdout.write(f"{path}\nLook at it: python -m mujoco.viewer --mjcf={path}\n")
    return 0
