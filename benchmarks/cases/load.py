"""Reading of houses from disk."""

import time
from collections.abc import Callable

from benchmarks.cases.record import BenchSettings, Measurement, make_measurement


def houses(settings: BenchSettings) -> Measurement:
    """Measure houses read per second; every OBJ, MTL and JSON file is parsed again."""
    from home_mjx.datasets.registry import open_dataset

    dataset = open_dataset(settings.root)
    ids = dataset.house_ids[: settings.num_houses]
    start = time.perf_counter()
    loaded = [dataset.load_house(house_id) for house_id in ids]
    seconds = (time.perf_counter() - start) / len(ids)
    meshes = {mesh.path: len(mesh.faces) for house in loaded for mesh in house.models.values()}
    note = f"{settings.describe(len(ids))}, {sum(meshes.values()):,} triangles in {len(meshes)} models"
    return make_measurement("load/houses", 1 / seconds, "houses/s", note)


CASES: dict[str, Callable[[BenchSettings], Measurement]] = {"houses": houses}
