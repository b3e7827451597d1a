"""Film of the story: the views of both agents, both storeys from above, and the carrier's binaural sound."""

from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from examples.story.play import Step
from examples.story.script import CARRIER, WATCHER
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.viewer.episodes.camera import scene_without_agents
from home_mjx.viewer.pictures import media, pictures
from home_mjx.viewer.pictures.top_view import Marker, TopView

Image = UInt8[np.ndarray, "_ _ 3"]
COLOURS = {CARRIER: (20, 200, 90), WATCHER: (255, 150, 40)}  # of the dots that stand for agents
LAMP = (255, 235, 90)
ACROSS = 5  # stages in a row of the sheet


@dataclass(frozen=True)
class Shot:
    """One step: the images and sounds of it."""

    caption: str
    eyes: tuple[Image, Image]  # of the carrier, of the watcher
    plans: tuple[Image, ...]  # of the storeys, from below
    sound: np.ndarray  # (2, n), at the ears of the carrier


@dataclass
class Film:
    """Collects the shots of a story: `told` is to be called after every step.

    Args:
        env: The environment, with sensors `rgb` and `audio`.
        lamp: Which body is carried.
    """

    env: Env[HouseholdEnv]
    lamp: int
    shots: list[Shot] = field(default_factory=list)

    def told(self, step: Step) -> None:
        """Adds a step."""
        rgb, sound = (np.asarray(step.state.obs[name]) for name in ("pixels/head_rgb", "audio"))
        self.shots.append(Shot(step.caption, (rgb[CARRIER], rgb[WATCHER]), self._plans(step), sound[CARRIER]))

    def write(self, folder: Path) -> None:
        """Writes `story.mp4`, `story.wav` and `story.png`, a sheet with the end of every stage."""
        sound = np.concatenate([shot.sound for shot in self.shots], axis=-1)
        media.write_wav(folder / "story.wav", sound, self.env.config.audio.sample_rate)
        peak = float(np.abs(sound).max())
        frames = np.stack([_frame(shot, peak) for shot in self.shots])
        media.write_mp4(folder / "story.mp4", frames, 1 / self.env.dt, folder / "story.wav")
        media.write_png(folder / "story.png", self._sheet())

    def _sheet(self) -> Image:
        ends = [list(shots)[-1] for _, shots in groupby(self.shots, key=lambda shot: shot.caption)]
        panels = [
            np.concatenate([pictures.add_caption(end.eyes[CARRIER], end.caption), end.eyes[WATCHER]]) for end in ends
        ]
        return pictures.compose_sheet([panels[i : i + ACROSS] for i in range(0, len(panels), ACROSS)])

    def _plans(self, step: Step) -> tuple[Image, ...]:
        scene, floors = scene_without_agents(self.env, step.state), np.asarray(self.env.bank.navigation.floor[0])
        marks = [Marker(step.moment.pos[agent], colour, 9) for agent, colour in COLOURS.items()]
        marks.append(Marker(step.moment.body_pos[self.lamp], LAMP, 5))
        storey = [int((mark.pos[2] > floors).sum()) - 1 for mark in marks]
        width = step.state.obs["pixels/head_rgb"].shape[-2]
        tops = [TopView(self.env.bank, scene, width, level) for level in range(len(floors))]
        return tuple(
            top.crop(top.draw_markers([mark for mark, at in zip(marks, storey, strict=True) if at == level]))
            for level, top in enumerate(tops)
        )


def _frame(shot: Shot, peak: float) -> Image:
    eyes = [
        pictures.add_caption(shot.eyes[CARRIER], f"carrier: {shot.caption}"),
        pictures.add_caption(shot.eyes[WATCHER], "watcher"),
    ]
    plans = [pictures.add_caption(image, f"storey {number}") for number, image in enumerate(shot.plans, 1)]
    width = sum(panel.shape[1] for panel in eyes) + 6
    wave = pictures.draw_waveform(shot.sound, width, 60, peak)
    return pictures.compose_sheet(
        [eyes, plans, [pictures.add_caption(wave, "the carrier's left ear (above), right ear (below)")]]
    )
