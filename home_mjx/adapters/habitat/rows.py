"""Episodes of Habitat as rows of a task bank, and back: houses for scenes, poses in the world frame."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jax
import numpy as np

from home_mjx.adapters.habitat.episodes import NavigationDataset, NavigationEpisode
from home_mjx.adapters.habitat.frames import NO_OFFSET, Vector, from_world, rotation_of, to_world, yaw_of
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import encode_name, vocabularies
from home_mjx.tasks.rules.enums import Attribute, Feature
from home_mjx.tasks.rules.program import Condition, Selector
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.suite.navigation import arrival_stage
from home_mjx.tasks.suite.task_io import convert_tasks
from home_mjx.tasks.validation.line_schema import TaskLine

# Our coarse categories for names of Habitat's that differ.
CATEGORIES: Mapping[str, str] = {
    "tv_monitor": "television",
    "tv": "television",
    "couch": "sofa",
    "potted plant": "plant",
    "chest_of_drawers": "dresser",
    "cabinet": "wardrobe_cabinet",
    "picture": "picture_frame",
    "cushion": "pillow",
    "stool": "chair",
}
SUCCESS_REWARD = 2.5  # added on success, as in `NavigationTask`
Offsets = Mapping[str, Vector]


def to_tasks(
    dataset: NavigationDataset, bank: HouseBank, success_distance: float, offsets: Offsets, path: str | Path
) -> TaskBank:
    """Return the episodes as tasks that end with `stop`: at the first goal point, or at an object of the category.

    Args:
        dataset: Episodes whose `house_id` is in the bank.
        bank: The houses.
        success_distance: Maximum distance on success [m].
        offsets: By house id, what the compiler added to the coordinates of its file, `CompiledHouse.offset` [m].
        path: The file of the episodes, for messages.

    Returns:
        The tasks. A length that is not that of the shortest path here is computed anew, with a warning in the log.

    Raises:
        DatasetError: A scene is not in the bank, a category is unknown or not in the house, or no path leads from the
            start to the goal; names the episode.
    """
    lines = []
    for number, episode in enumerate(dataset.episodes):
        try:
            lines.append(_task_line(episode, success_distance, offsets.get(episode.house_id, NO_OFFSET)))
        except ConfigError as error:  # of a category
            raise DatasetError(error.message, file=path, element=f"episodes[{number}]", hint=error.hint) from None
    try:
        return convert_tasks(lines, bank, path)
    except DatasetError as error:
        where = (error.element or "line 1").split(",")[0].removeprefix("line ")
        hint = error.hint or "Give the houses of the episodes, and `offsets` if their frames differ."
        raise type(error)(error.message, file=path, element=f"episodes[{int(where) - 1}]", hint=hint) from None


def _task_line(episode: NavigationEpisode, success_distance: float, offset: Vector) -> TaskLine:
    """Return the task of an episode; `UnknownNameError` for an unknown category."""
    near = Condition(Feature.DISTANCE, 0, maximum=success_distance)
    if episode.object_category is None:
        selector, needed = Selector.point(to_world(episode.goals[0].position, offset)), (near,)
    else:
        name = CATEGORIES.get(episode.object_category, episode.object_category)
        selector = Selector.objects(coarse=encode_name(Semantic.COARSE, name))
        needed = (near, Condition(Feature.SEEN, 0, minimum=1))
    return TaskLine(
        house=episode.house_id,
        task="PointGoals" if episode.object_category is None else "ObjectNav",
        start=to_world(episode.start_position, offset),
        yaw=yaw_of(episode.start_rotation),
        length=float(episode.info.get("geodesic_distance", 0.0)),
        instruction="",
        selectors=(selector,),
        stages=(arrival_stage(needed, stop=True, reward=SUCCESS_REWARD),),
    )


def to_episodes(tasks: TaskBank, bank: HouseBank, offsets: Offsets) -> tuple[NavigationEpisode, ...]:
    """Return tasks to points or objects as episodes of Habitat, in order; ids are the numbers of the rows.

    `scene_id` is the id of the house. `offsets` as for `to_tasks`.

    Example:
        >>> dataset = NavigationDataset(to_episodes(env.params.tasks, env.bank, {}), {})  # doctest: +SKIP
        >>> write_dataset("val.json.gz", dataset)  # doctest: +SKIP
    """
    rows = jax.tree.map(np.asarray, tasks.rows)
    return tuple(_episode(number, rows, bank.house_ids, offsets) for number in range(len(rows)))


def _episode(number: int, rows: Any, house_ids: Sequence[str], offsets: Offsets) -> NavigationEpisode:
    """Return the episode of a row of a task bank, with Habitat's fields in Habitat's order."""
    house = house_ids[int(rows.house[number])]
    offset = offsets.get(house, NO_OFFSET)
    place, coarse = rows.columns["place"][number, 0], rows.columns["descriptor"][number, 0, Attribute.COARSE]
    is_point = bool(np.isfinite(place).all())
    goals = [{"position": list(from_world(place.tolist(), offset)), "radius": None}] if is_point else []
    fields = {
        "episode_id": str(number),
        "scene_id": house,
        "scene_dataset_config": "default",
        "additional_obj_config_paths": [],
        "start_position": list(from_world(rows.start[number].tolist(), offset)),
        "start_rotation": list(rotation_of(float(rows.yaw[number]))),
        "info": {"geodesic_distance": float(rows.columns["length"][number])},
        "goals": goals,
        "start_room": None,
        "shortest_paths": None,
    }
    category = {} if is_point else {"object_category": vocabularies()[Semantic.COARSE][int(coarse)]}
    return NavigationEpisode(fields | category)
