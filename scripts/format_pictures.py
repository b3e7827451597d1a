"""Draw houses of six sources, rendered as one batch by one program, for the pages of household datasets.

python scripts/format_pictures.py [--out docs/images] [--samples 9] [--others]

All houses may be published: generated homes, as they are, as SUNCG's files, and exported to glTF, MJCF and Habitat and
read back; and the house in ProcTHOR's format of the tests, in our furniture. The pages of glTF, MJCF and Habitat get
views of their own, and the sheet has all of them. With `--others`, pictures of USD and 3D-FRONT are drawn instead, of
generated homes that `format_houses.py` writes in these formats; USD needs usd-core.
"""

import argparse
import functools
import sys
import tempfile
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from format_houses import write_front, write_usd
from gallery import FINE, SIZE, Studio
from PIL import Image

from home_mjx.bank.bank import HouseBank
from home_mjx.datasets import open_dataset
from home_mjx.houses.house_cache import load_compiled
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.scene_compile.gltf.export import export_gltf
from home_mjx.scene_compile.gltf.habitat_export import export_habitat
from home_mjx.scene_compile.mjcf.export import export_mjcf
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.viewer.pictures import pictures
from home_procgen import generate_dataset

ROOT = Path(__file__).resolve().parent.parent
SEEDS = {"procedural": 3, "suncg": 11, "gltf": 20, "habitat": 42, "mjcf": 7, "usd": 20, "front": 5}
PAGES = ("gltf", "habitat", "mjcf")  # formats that have pictures of their own
QUALITY = 80  # of JPEG


def write_houses(root: Path) -> dict[str, str]:
    """Write a house of each format below a folder, and return the names of the datasets."""
    sys.path.insert(0, str(ROOT / "tests" / "helpers"))
    from thor_houses import write_house

    (root / "procthor").mkdir()
    generate_dataset(root / "suncg", [SEEDS["suncg"]])
    export_gltf(home(SEEDS["gltf"]), root / "house.glb")
    export_mjcf(home(SEEDS["mjcf"]), root / "mjcf")
    return {
        "procedural": f"procedural:1?seed={SEEDS['procedural']}",
        "suncg": str(root / "suncg"),
        "procthor": f"procthor:{write_house(root / 'procthor')}",
        "gltf": f"gltf:{root / 'house.glb'}",
        "habitat": f"habitat:{export_habitat(home(SEEDS['habitat']), root / 'habitat')}",
        "mjcf": f"mjcf:{root / 'mjcf'}",
    }


def home(seed: int) -> CompiledHouse:
    """Return the generated home of a seed."""
    return first_house(f"procedural:1?seed={seed}")


def first_house(name: str) -> CompiledHouse:
    """Return the first house of a dataset."""
    dataset = open_dataset(name)
    dataset.prepare(dataset.house_ids[:1])
    return load_compiled(dataset, dataset.house_ids[0])


def draw_batch(bank: HouseBank, cameras: list[Camera], samples: int) -> np.ndarray:
    """Return one picture of each house, (houses, rows, columns, 3), by one program that is compiled once."""
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    look = functools.partial(render, lens=Lens(*SIZE, samples=samples), kinds=("rgb",), shader=FINE)

    def draw(house, camera):
        physics = bank.physics
        return look(make_scene(bank, house, physics.body_pos[house], physics.body_quat[house], *nobody), camera)["rgb"]

    houses = jnp.arange(len(cameras), dtype=jnp.int32)
    return np.asarray(jax.jit(jax.vmap(draw))(houses, jax.tree.map(lambda *leaves: jnp.stack(leaves), *cameras)))


def main() -> None:
    """Draw and write all pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    parser.add_argument("--samples", type=int, default=9, help="rays per pixel")
    parser.add_argument("--others", action="store_true", help="only pictures of USD and 3D-FRONT")
    args = parser.parse_args()
    if args.others:
        draw_others(args.out, args.samples)
        return
    with tempfile.TemporaryDirectory() as folder:
        names = write_houses(Path(folder))
        bank = HouseBank.from_compiled([first_house(name) for name in names.values()])
    cameras = [Studio(bank, house).views(1)[0] for house in range(bank.num_houses)]
    images = dict(zip(names, draw_batch(bank, cameras, args.samples), strict=True))
    tiles = [pictures.add_caption(image, name) for name, image in images.items()]
    write(args.out / "formats.jpg", pictures.compose_sheet([tiles[:3], tiles[3:]]))
    for name in PAGES:
        write(args.out / f"format_{name}.jpg", images[name])


def draw_others(out: Path, samples: int) -> None:
    """Draw and write the pictures of USD and 3D-FRONT."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "front").mkdir()
        paths = {
            "usd": write_usd(home(SEEDS["usd"]), folder / "house.usda"),
            "front": write_front(home(SEEDS["front"]), folder / "front"),
        }
        bank = HouseBank.from_compiled([first_house(f"{key}:{path}") for key, path in paths.items()])
    cameras = [Studio(bank, house).views(1)[0] for house in range(bank.num_houses)]
    for key, image in zip(paths, draw_batch(bank, cameras, samples), strict=True):
        write(out / f"format_{key}.jpg", image)


def write(path: Path, image: np.ndarray) -> None:
    """Write a picture, and print its size."""
    Image.fromarray(image).save(path, quality=QUALITY, optimize=True)
    print(path, f"{path.stat().st_size / 1024:.0f} kB")


if __name__ == "__main__":
    main()
