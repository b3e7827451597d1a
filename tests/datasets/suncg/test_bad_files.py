"""Files that were once a danger, or would be to another reader, each in the place of one file of a tiny dataset."""

import time
import tracemalloc
from pathlib import Path

import pytest
from fuzz_corpus import Watch, compile_the_compiler
from tiny_dataset import HOUSE_ID, TABLE, write_tiny_dataset

from home_mjx.errors import DatasetError, HomeMjxError

FOLDER = Path(__file__).parent / "bad_files"
SECONDS, MEBIBYTES = 5.0, 64
PLACES = {  # what a file stands for, by the first word of its name
    "house": f"house/{HOUSE_ID}/house.json",
    "table": f"object/{TABLE}/{TABLE}.obj",
    "library": f"object/{TABLE}/{TABLE}.mtl",
    "image": "texture/wood_1.png",
    "lights": "metadata/suncgModelLights.json",
    "sizes": "metadata/models.csv",
    "categories": "metadata/ModelCategoryMapping.csv",
    "floor": f"room/{HOUSE_ID}/fr_0rm_0f.obj",
    "walls": f"room/{HOUSE_ID}/fr_0rm_0w.obj",
}
NODE = "levels[0].nodes"
EXPECTED = {  # element, and how the message begins
    "categories-not-utf8.csv": ("line 3", "byte 201 is not UTF-8"),
    "floor-of-kilometres.obj": (f"{NODE}[0]", "rooms reach over 400000 x 300000 m"),  # the error is house.json's
    "house-flipped-bit.json": ("line 1, column 214", "not valid JSON"),
    "house-infinite-bbox.json": (f"{NODE}[2].bbox.max[1]", "expected a finite number, got `Infinity`"),
    "house-lists-in-lists.json": (f"{NODE}[2].transform", "expected 16 numbers, got 1"),
    "house-model-outside.json": (f"{NODE}[2].modelId", "`../../../../etc/passwd` is not a plain name"),
    "house-nan-transform.json": (f"{NODE}[2].transform[12]", "expected a finite number, got `NaN`"),
    "house-nodes-not-a-list.json": (NODE, "expected a list"),
    "house-not-utf8.json": ("line 1", "byte 335 is not UTF-8"),
    "house-number-of-a-thousand-digits.json": (f"{NODE}[4].dimensions[0]", "expected a finite number"),
    "house-room-outside.json": (f"{NODE}[0].modelId", "`../../object/9001/9001` is not a plain name"),
    "house-texture-outside.json": (f"{NODE}[4].materials[0].texture", "path `../../../etc/passwd` leads out"),
    "house-truncated.json": ("line 1, column 1129", "not valid JSON"),
    "image-four-gigapixels.png": (None, "cannot read texture: DecompressionBomb"),
    "image-of-90-megapixels-in-11-kilobytes.png": (None, "cannot read texture: DecompressionBomb"),
    "image-truncated.png": (None, "cannot read texture: image file is truncated"),
    "image-whose-text-unpacks-to-megabytes.png": (None, "cannot read texture: ValueError"),
    "library-image-outside.mtl": ("line 3", "path `../../../../../../etc/passwd.png` leads out of the dataset"),
    "library-nan-colour.mtl": ("line 2", "expected 3 finite number(s), got `nan 0 0`"),
    "library-not-utf8.mtl": ("line 10", "byte 115 is not UTF-8"),
    "lights-nan-power.json": (f"{TABLE}[0].power", "expected a finite number, got `NaN`"),
    "sizes-infinite.csv": ("line 2", "expected three finite numbers, got `-inf, 0.0, -0.4`"),
    "table-infinite-vertex.obj": ("line 6", "expected finite numbers, got `0 1e999 0`"),
    "table-library-is-itself.obj": ("line 14", "material `material_0` is not in the material library"),
    "table-library-outside.obj": ("line 1", "path `../../../../../../etc/passwd` leads out of the dataset"),
    "table-nan-vertex.obj": ("line 6", "expected finite numbers, got `nan 0 0`"),
    "table-not-utf8.obj": ("line 6", "byte 49 is not UTF-8"),
    "table-ten-million-corners-claimed.obj": ("line 15", "face refers to `v` 10000000, but the file has 16"),
    "table-truncated.obj": ("line 15", "expected a face such as `f 1/1/1 2/2/2 3/3/3`, got `1/1 2/`"),
}
HARMLESS = {"walls-without-length.obj"}  # compiled; the direction of such a wall was once 0 / 0


class Listening(Watch):
    """Keeps the errors."""

    def check(self, error: HomeMjxError) -> None:
        super().check(error)
        self.found.append(error)


@pytest.fixture(scope="module", autouse=True)
def _compiler():
    compile_the_compiler()


def test_every_file_is_expected():
    assert {path.name for path in FOLDER.iterdir()} == {*EXPECTED, *HARMLESS}


@pytest.mark.parametrize("name", sorted({*EXPECTED, *HARMLESS}))
def test_a_bad_file_gives_one_located_error_and_touches_nothing_else(tmp_path, name):
    """Loaded, validated, compiled and decoded: nothing outside of the root is read and nothing is written."""
    root = write_tiny_dataset(tmp_path)
    place = root / PLACES[name.partition("-")[0]]
    place.write_bytes((FOLDER / name).read_bytes())
    watch = Listening(root, compiles=True)
    watch.found = []
    watch.read()
    wrong = {(isinstance(error, DatasetError), error.file, error.element) for error in watch.found}
    if name in HARMLESS:
        assert not wrong
        return
    element, message = EXPECTED[name]
    file = root / PLACES["house"] if name.startswith("floor") else place
    assert wrong == {(True, str(file), element)}
    assert all(error.message.startswith(message) for error in watch.found)
    assert watch.worst < SECONDS


@pytest.mark.parametrize(
    "name", [name for name in sorted(EXPECTED) if name.startswith(("image", "floor", "table-ten"))]
)
def test_claims_of_size_cost_no_memory(tmp_path, name):
    root = write_tiny_dataset(tmp_path)
    (root / PLACES[name.partition("-")[0]]).write_bytes((FOLDER / name).read_bytes())
    watch = Watch(root, compiles=True)
    tracemalloc.start()
    begin = time.process_time()
    watch.read()
    assert tracemalloc.get_traced_memory()[1] < MEBIBYTES << 20
    tracemalloc.stop()
    assert time.process_time() - begin < SECONDS
    assert watch.errors == 1
