"""Draw the images of docs/tasks/: an expert's episode of every task, its lit view and the plan of the house.

    python scripts/task_pictures.py [--id ID ...] [--row N ...] [--out FOLDER]

Without `--row`, the rows in `SHOWN` are drawn; with it, candidates, `NAME_ROW.jpg` each.
"""

import argparse
import dataclasses
import io
import re
from pathlib import Path
from typing import Any

import jax
import numpy as np
from PIL import Image

import home_mjx
import home_mjx.tasks.suite
from home_mjx.core.compile_cache import use_compile_cache
from home_mjx.tasks import add_expert
from home_mjx.tasks.env.observers import EpisodeStep, Observer
from home_mjx.training.evaluation import with_episodes
from home_mjx.viewer.episodes.camera import CameraShot, FilmCamera, scene_without_agents
from home_mjx.viewer.episodes.episode import EpisodeRunner
from home_mjx.viewer.episodes.goal_markers import get_goal_markers, get_instruction, get_utterances
from home_mjx.viewer.episodes.overlay import TopDownOverlay
from home_mjx.viewer.episodes.policies import PolicyPlayer, make_policy
from home_mjx.viewer.episodes.video import compose_frame

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "docs" / "images" / "tasks"
WIDTH, HEIGHT, SAMPLES = 360, 270, 4
HOUSES = 4
ROWS = 6  # rows per house
LARGEST = 60_000  # maximum size of an image [bytes]


@dataclasses.dataclass(frozen=True)
class Shown:
    """Row of a task, and the step that is drawn: the last one, or a fraction of the episode."""

    row: int = 0
    part: float = 1.0
    options: dict[str, Any] = dataclasses.field(default_factory=dict)


ROWS_SHOWN = {
    "RoomNav-v0": 19, "ObjectNav-v0": 14, "PointNav-v0": 19, "VQA-v0": 14, "HouseQA-v0": 14, "Communication-v0": 14,
    "AudioNav-v0": 14, "Dialogue-v0": 7, "InstructionFollowing-v0": 3, "Fetch-v0": 7, "Rearrange-v0": 14,
    "Toggle-v0": 19, "FetchFromContainer-v0": 7,
}  # fmt: skip
SHOWN = {env_id: Shown(ROWS_SHOWN.get(env_id, 0)) for env_id in home_mjx.list_envs()} | {
    "PiedPiper-v0": Shown(14, part=0.7),
    "Exploration-v0": Shown(19, options={"episode_length": 200}),
}


def main() -> None:
    """Play episodes and draw their images."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--id", action="append", help="default: every id")
    parser.add_argument("--row", action="append", type=int)
    parser.add_argument("--out", type=Path, default=OUT)
    args = parser.parse_args()
    use_compile_cache()
    args.out.mkdir(parents=True, exist_ok=True)
    for env_id in args.id or home_mjx.list_envs():
        artist = Artist(env_id)
        for row in args.row or [SHOWN[env_id].row]:
            picture, text = artist.picture(row)
            name = artist.name if args.row is None else f"{artist.name}_{row}"
            (args.out / f"{name}.jpg").write_bytes(jpeg(picture))
            print(f"{name}: row {row}: {text}", flush=True)


@dataclasses.dataclass
class Steps(Observer):
    """All steps of an episode."""

    steps: list[EpisodeStep]

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Keep the step."""
        self.steps.append(step)


class Artist:
    """Renderer of episodes of one id.

    Args:
        env_id: The id.
    """

    def __init__(self, env_id: str) -> None:
        self.shown = SHOWN[env_id]
        task = getattr(home_mjx.tasks.suite, home_mjx.registry.find_spec(env_id).entry_point.partition(":")[2])
        options = {"num_tasks": ROWS} if hasattr(task, "num_tasks") else {}
        options |= {"num_houses": HOUSES, "split": "val", "sensors": ("state",), "impl": "kinematic"}
        self.env = add_expert(with_episodes(home_mjx.make(env_id, **options, **self.shown.options), ROWS * HOUSES))
        self.name = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", env_id.partition("-v")[0]).lower()
        self.game, self.camera = EpisodeRunner(self.env), FilmCamera(self.env, WIDTH, HEIGHT, SAMPLES)
        self.player = PolicyPlayer(self.env.core, make_policy(self.env, "expert"))
        self.pose = jax.jit(lambda params, state: self.env.core.snapshot(params, state).pose)

    def picture(self, row: int) -> tuple[np.ndarray, str]:
        """Return the image of a row, and a description of the episode."""
        number = row if self.env.params.tasks is not None else None
        recorded = Steps([])
        outcome = self.game.run(self.player, 1, jax.random.key(row), number, recorded)
        steps = recorded.steps
        last = round(self.shown.part * (len(steps) - 1))
        sights = [self._place(step) for step in steps[:last]] + [self.camera.capture(steps[last].state)]
        state = steps[last].state
        # No goal is left in a terminal state.
        before = steps[max(last - 1, 0)].state if state.terminated else state
        goals = get_goal_markers(self.env.bank, before, sights[-1].boxes)
        top = TopDownOverlay(self.env.bank, int(state.world.house)).draw(
            scene_without_agents(self.env, state), sights, goals
        )
        over, how = last == len(steps) - 1, "success" if outcome.success else "failure"
        words = ", ".join(dict.fromkeys(word for step in steps[: last + 1] for word in get_utterances(step.state)))
        status = f"expert   {f'{how}   ' if over else ''}{last} steps{f'   said {words}' if words else ''}"
        picture = compose_frame(
            sights[-1].view, top, get_instruction(self.env, state).text, status, outcome.success > 0 if over else None
        )
        return picture, outcome.format_line()

    def _place(self, step: EpisodeStep) -> CameraShot:
        pose = self.pose(self.env.params, step.state)
        return CameraShot(
            np.zeros((1, 1, 3), np.uint8), np.asarray(pose.pos), np.asarray(pose.yaw), np.zeros((0, 2, 3))
        )


def jpeg(picture: np.ndarray) -> bytes:
    """Encode an image with the highest quality that fits `LARGEST` bytes."""
    for quality in (88, 84, 80, 75, 70, 60):
        file = io.BytesIO()
        Image.fromarray(picture).save(file, "jpeg", quality=quality, optimize=True)
        if file.tell() <= LARGEST:
            break
    return file.getvalue()


if __name__ == "__main__":
    main()
