"""Images of the walk."""

from dataclasses import dataclass, field
from pathlib import Path

import jax
import numpy as np

from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.viewer.pictures import media, pictures
from home_mjx.viewer.pictures.top_view import TopView


@dataclass
class WalkRecord:
    """Observations and positions of a walk, for each drawn environment."""

    obs: list[dict[str, np.ndarray]] = field(default_factory=list)
    positions: list[np.ndarray] = field(default_factory=list)
    sources: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))

    def most_varied_observation(self, view: int) -> dict[str, np.ndarray]:
        """Return all drawn environments' observations at the step in which environment `view` observes most instances.

        Each view has its own share of the steps: agents of one house would otherwise all be drawn at the same place.
        """
        num_views = len(self.sources)
        part = slice(len(self.obs) * view // num_views, max(len(self.obs) * (view + 1) // num_views, 1))
        return max(self.obs[part] or self.obs, key=lambda obs: len(np.unique(obs["ids/head_instance"][view])))


def write_contact_sheet(env: Env[HouseholdEnv], states: State, walk: WalkRecord, folder: Path) -> None:
    """Write `contact_sheet.png`, a row per environment: plan with path, and images of its most varied observation."""
    houses = np.asarray(states.world.house)
    tops = [TopView(env.bank, _scene(env, states, i)) for i in range(len(houses))]
    paths = np.stack(walk.positions)
    rows = []
    for i, top in enumerate(tops):
        image = top.draw_path(paths[:, i], walk.sources[i], size=256)
        caption = f"house {houses[i]}: path, end (green), radio (red)"
        rows.append([pictures.add_caption(image, caption), *_views(env, walk.most_varied_observation(i), i, 256)])
    media.write_png(folder / "contact_sheet.png", pictures.compose_sheet(rows))


def _scene(env: Env[HouseholdEnv], states: State, index: int) -> Scene:
    """Return the scene of environment `index` of a batch of states, for ray casting."""
    return env.core.snapshot(env.params, jax.tree.map(lambda x: x[index], states)).scene


def _views(env: Env[HouseholdEnv], obs: dict[str, np.ndarray], view: int, size: int) -> list[np.ndarray]:
    panels = {
        "rgb": obs["pixels/head_rgb"][view],
        "depth": pictures.colour_depth(obs["pixels/head_depth"][view, ..., 0], env.config.max_depth),
        "category": pictures.colour_ids(obs["ids/head_fine"][view]),
        "instance": pictures.colour_ids(obs["ids/head_instance"][view]),
    }
    return [pictures.add_caption(pictures.enlarge(image, size), name) for name, image in panels.items()]
