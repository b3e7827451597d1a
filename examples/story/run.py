"""The story from its house to its film."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from examples.story.film import Film
from examples.story.house import write_story_house
from examples.story.places import Places
from examples.story.play import Step, make_story_env, play
from home_mjx.core.files import write_all_or_none


@dataclass(frozen=True)
class StoryOptions:
    """Options of the film.

    Attributes:
        out: Folder for the files.
        width: Of each agent's picture [px].
        height: [px].
        samples: Rays per pixel.
    """

    out: Path = Path("demo")
    width: int = 320
    height: int = 240
    samples: int = 2


def run_story(options: StoryOptions) -> float:
    """Plays the story and films it.

    Returns:
        Its length [s].

    Raises:
        HomeMjxError: A stage of the story took longer than its limit.
    """
    with tempfile.TemporaryDirectory(prefix="home_mjx_story_") as root, tqdm(desc="story", unit="step") as steps:
        write_story_house(Path(root))
        sight = {"width": options.width, "height": options.height, "samples": options.samples}
        env = make_story_env(Path(root), sensors=("rgb", "audio"), fovy=65, shader="lit", **sight)
        film = Film(env, Places.of(env.bank).lamp.body)

        def told(step: Step) -> None:
            steps.set_postfix_str(step.caption)
            film.told(step)
            steps.update()

        play(env, told)
        with write_all_or_none(options.out, "story") as folder:
            film.write(folder)
    return len(film.shots) * env.dt
