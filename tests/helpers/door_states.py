"""Houses whose doors are in the other state than the dataset puts them."""

from collections.abc import Callable
from dataclasses import replace

from home_mjx.datasets.suncg.dataset import SuncgDataset
from home_mjx.datasets.suncg.formats.variants import other_variant, variant_key
from home_mjx.datasets.suncg.read.door_joints import find_joints
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House, Mesh, ObjectNode


def other_state(dataset: SuncgDataset, node: ObjectNode) -> Mesh:
    """The mesh of an object's other state; DatasetError without one."""
    return dataset.load_model(other_variant(node.model_id, node.model_key))


def with_doors(
    dataset: SuncgDataset, house: House, closed: bool, chosen: Callable[[ObjectNode], bool] = lambda node: True
) -> House:
    """The first level's doors of two states, all or those chosen, open or closed."""
    level, models = house.levels[0], dict(house.models)
    objects = []
    for node in level.objects:
        changed = node
        if chosen(node) and dataset.metadata.info(node.model_id).coarse == "door":
            changed = _in_state(dataset, node, closed, models)
        objects.append(changed)
    return replace(house, models=models, levels=(replace(level, objects=tuple(objects)), *house.levels[1:]))


def _in_state(dataset: SuncgDataset, node: ObjectNode, closed: bool, models: dict[str, Mesh]) -> ObjectNode:
    key = variant_key(node.model_id, int(closed))
    try:
        shown, other = dataset.load_model(key), dataset.load_model(other_variant(node.model_id, key))
    except DatasetError:
        return node
    models[key] = shown
    return replace(node, model_key=key, joints=find_joints(key, shown, other, closed))
