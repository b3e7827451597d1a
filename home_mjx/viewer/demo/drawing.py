"""Images of the walk: a row per agent with its view, its sensors and the plan of every storey."""

from dataclasses import dataclass, field
from pathlib import Path

import jax
import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.viewer.episodes.camera import FilmCamera, scene_without_agents
from home_mjx.viewer.pictures import media, pictures
from home_mjx.viewer.pictures.top_view import AGENT_COLOUR, FLOOR_MARGIN, SOURCE_COLOUR, Marker, TopView, find_level

WIDTH, HEIGHT = 640, 480  # [px] of a view
INSET_SCALE, INSET_MARGIN = 2, 8  # factor of the observed image in a corner of the view, and its margin [px]
PLAN_LEGEND = ": path (blue), agent (green), radio (red; heard, but not sought)"

Picture = UInt8[np.ndarray, "_ _ 3"]


@dataclass
class WalkRecord:
    """A walk of the drawn environments.

    Attributes:
        sources: (N, 3) positions of the radios [m].
        positions: (N, 3) positions of the agents in each step [m].
        moments: State and observations of each environment at the step in which it observes most instances.
    """

    sources: Float[np.ndarray, "n 3"]
    positions: list[Float[np.ndarray, "n 3"]] = field(default_factory=list)
    moments: dict[int, tuple[int, State, dict[str, np.ndarray]]] = field(default_factory=dict)

    def add(self, states: State, positions: Float[np.ndarray, "n 3"]) -> None:
        """Append a step of all environments; replace a moment if its agent now observes more instances.

        At equal numbers the earlier moment stays. The observation `ids/head_instance` is needed.
        """
        self.positions.append(positions)
        ids = np.asarray(states.obs["ids/head_instance"])
        for i in range(len(ids)):
            count = len(np.unique(ids[i]))
            if i not in self.moments or count > self.moments[i][0]:
                one = jax.tree.map(lambda x, i=i: x[i], states)
                self.moments[i] = count, one, {k: np.asarray(v) for k, v in one.obs.items()}


def write_contact_sheet(env: Env[HouseholdEnv], walk: WalkRecord, folder: Path) -> None:
    """Write `contact_sheet.png`: a row per environment, at the step in which its agent observes most instances.

    The agents follow the shortest path to the farthest goal; they hear a radio and do not seek it. A row shows the
    agent's view, its depth and category images, and a plan of each storey with the path.
    """
    camera = FilmCamera(env, WIDTH, HEIGHT)
    paths = np.stack(walk.positions)
    rows = []
    for i, (_, state, obs) in sorted(walk.moments.items()):
        view = _add_inset(camera.capture(state).view, obs["pixels/head_rgb"])
        plans = _draw_plans(env, state, paths[:, i], walk.sources[i])
        house = int(state.world.house)
        caption = f"home {house}: view of an agent on its way to the farthest goal; inset: what it observes"
        names = [f"storey {level}" for level in range(len(plans))]
        names[-1] += PLAN_LEGEND
        rows.append([pictures.add_caption(view, caption), pictures.add_caption(_sensors(env, obs), "depth, category")])
        rows[-1] += [pictures.add_caption(plan, name) for plan, name in zip(plans, names, strict=True)]
    media.write_png(folder / "contact_sheet.png", pictures.compose_sheet(rows))


def _add_inset(view: Picture, observed: Picture) -> Picture:
    """Return a copy of a view with the observed, square image, twice as large and framed, in its lower right corner."""
    inset = np.pad(pictures.enlarge(observed, INSET_SCALE * observed.shape[1]), [(2, 2), (2, 2), (0, 0)])
    out, (height, width) = view.copy(), inset.shape[:2]
    out[-height - INSET_MARGIN : -INSET_MARGIN, -width - INSET_MARGIN : -INSET_MARGIN] = inset
    return out


def _sensors(env: Env[HouseholdEnv], obs: dict[str, np.ndarray]) -> Picture:
    """Return the observed depth above the observed fine categories, in colours, `HEIGHT` rows together."""
    depth = pictures.colour_depth(obs["pixels/head_depth"][..., 0], env.config.max_depth)
    category = pictures.colour_ids(obs["ids/head_fine"])
    return np.concatenate([pictures.enlarge(image, HEIGHT // 2) for image in (depth, category)])


def _draw_plans(
    env: Env[HouseholdEnv], state: State, path: Float[np.ndarray, "t 3"], source: Float[np.ndarray, " 3"]
) -> list[Picture]:
    """Return the plan of each storey, lowest first, with the part of the path on it.

    The end of the path and the radio are only on the plan of their storey.
    """
    house, scene = int(state.world.house), scene_without_agents(env, state)
    raised = np.array([0.0, 0.0, FLOOR_MARGIN])
    levels = [find_level(env.bank, house, point + raised) for point in (*path, source)]
    plans = []
    for level in range(int(np.isfinite(np.asarray(env.bank.navigation.floor[house])).sum())):
        top = TopView(env.bank, scene, 2 * HEIGHT, level)
        ends = (levels[-2], Marker(path[-1], AGENT_COLOUR, 7)), (levels[-1], Marker(source, SOURCE_COLOUR, 9))
        marks, own = [mark for at, mark in ends if at == level], path[np.array(levels[:-1]) == level]
        image = Image.fromarray(top.draw_markers(marks, own if len(own) else None))
        plans.append(np.asarray(image.resize((HEIGHT, HEIGHT), Image.Resampling.LANCZOS)))
    return plans
