"""Frames of a film: the agent's view, a plan beside it, the instruction above, the status below."""

import math
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, ImageDraw, ImageFont

from home_mjx.viewer.episodes.overlay import AGENT_COLOURS, GOAL_COLOUR, PATH_COLOUR
from home_mjx.viewer.pictures import media
from home_mjx.viewer.pictures.pictures import BACKGROUND, TEXT_COLOUR, compose_sheet

PANEL_GAP = 8  # [px] space between the panels
TEXT_HEIGHT = 26  # [px] height of a line of text
SUCCESS_COLOUR, FAILURE_COLOUR, RUNNING_COLOUR = (60, 190, 100), (225, 80, 70), (150, 155, 165)
FINAL_FRAME_SECONDS = 1.5  # [s] display time of the last frame of an episode
MIN_FPS = 6.0  # minimum frames per second; steps of 0.3 s would stutter

MAX_LEGEND_SIZE = 22  # [px] maximum height of the legend's text, on a plan of 640 px
LEGEND = (("goal", GOAL_COLOUR, False), ("path", PATH_COLOUR, True), ("agent", AGENT_COLOURS[0], True))

RgbImage = UInt8[np.ndarray, "_ _ 3"]


def compose_frame(view: RgbImage, plan: RgbImage, title: str, status: str, success: bool | None = None) -> RgbImage:
    """Compose a frame: `title` above, view left of the plan with its legend, `status` below; both sides are even.

    The plan and its legend are scaled to fit the size of the view, which keeps its own. `success` colours the
    background of the status: True green, False red, None (not ended) neutral.
    """
    height, width = view.shape[:2]
    beside = fit_image(add_legend(plan), width, height)
    size = (width + beside.shape[1] + 3 * PANEL_GAP, height + 2 * TEXT_HEIGHT + 2 * PANEL_GAP)
    canvas = Image.new("RGB", (size[0] + size[0] % 2, size[1] + size[1] % 2), BACKGROUND)  # H.264 needs even sides
    canvas.paste(Image.fromarray(view), (PANEL_GAP, TEXT_HEIGHT + PANEL_GAP))
    canvas.paste(Image.fromarray(beside), (width + 2 * PANEL_GAP, TEXT_HEIGHT + PANEL_GAP))
    draw = ImageDraw.Draw(canvas)
    _line(draw, title, 6, TEXT_COLOUR, 17, canvas.width)
    colour = RUNNING_COLOUR if success is None else SUCCESS_COLOUR if success else FAILURE_COLOUR
    if success is not None:
        draw.rectangle((0, size[1] - TEXT_HEIGHT, canvas.width, canvas.height), fill=colour)
    _line(
        draw, status, size[1] - TEXT_HEIGHT + 5, TEXT_COLOUR if success is None else (255, 255, 255), 14, canvas.width
    )
    return np.asarray(canvas)


def add_legend(plan: RgbImage) -> RgbImage:
    """Return a plan with a line below it that names its marks: the ring of the goal, path and agent."""
    height, width = plan.shape[:2]
    size = max(8, min(MAX_LEGEND_SIZE, width // 16))  # [px] of the text
    canvas = Image.new("RGB", (width, height + 2 * size), BACKGROUND)
    canvas.paste(Image.fromarray(plan))
    draw, font, left, middle = ImageDraw.Draw(canvas), ImageFont.load_default(size=size), size / 2, height + size
    for name, colour, is_filled in LEGEND:
        box = (left, middle - size / 3, left + 2 * size / 3, middle + size / 3)
        draw.ellipse(box, fill=colour if is_filled else None, outline=colour, width=max(1, size // 8))
        draw.text((left + size, middle), name, fill=TEXT_COLOUR, font=font, anchor="lm")
        left += 2 * size + font.getlength(name)
    return np.asarray(canvas)


def fit_image(image: RgbImage, width: int, height: int) -> RgbImage:
    """Scale an image up or down, aspect ratio kept, to fit a box [px], and centre it there on the background."""
    scale = min(width / image.shape[1], height / image.shape[0])
    size = max(1, math.floor(image.shape[1] * scale)), max(1, math.floor(image.shape[0] * scale))
    canvas = Image.new("RGB", (width, height), BACKGROUND)
    small = Image.fromarray(image).resize(size, Image.Resampling.LANCZOS)
    canvas.paste(small, ((width - size[0]) // 2, (height - size[1]) // 2))
    return np.asarray(canvas)


def _line(draw: ImageDraw.ImageDraw, text: str, top: int, colour: tuple, size: int, width: int) -> None:
    """Draw text with its left end at `PANEL_GAP` and its top at `top` [px].

    The font shrinks from `size` until the text fits `width` without a margin of `PANEL_GAP` on both sides. At size 8
    longer text is cut off.
    """
    while size > 8 and ImageFont.load_default(size=size).getlength(text) > width - 2 * PANEL_GAP:
        size -= 1
    draw.text((PANEL_GAP, top), text, fill=colour, font=ImageFont.load_default(size=size))


@dataclass
class VideoWriter:
    """Frames of all episodes, and their sound.

    Args:
        dt: Time of a step [s].
        sample_rate: Sample rate of the sound [Hz]; None: silent, and playback may be faster than real time.
    """

    dt: float
    sample_rate: int | None = None
    frames: list[RgbImage] = field(default_factory=list)
    sounds: list[Float[np.ndarray, "2 n"]] = field(default_factory=list)
    ends: list[RgbImage] = field(default_factory=list)

    @property
    def fps(self) -> float:
        """Frames per second: real time with sound, else at least `MIN_FPS`."""
        return 1 / self.dt if self.sample_rate else max(1 / self.dt, MIN_FPS)

    def add(self, picture: RgbImage, sound: Float[np.ndarray, "2 n"] | None = None) -> None:
        """Add the frame and the sound of a step; None is silence. Without a sample rate, sound is ignored.

        All frames must have one size, else `write` raises `ValueError`; it is not checked here. Nor is the length of a
        sound, which should be that of a step.
        """
        self.frames.append(picture)
        if self.sample_rate:
            self.sounds.append(np.zeros((2, round(self.sample_rate * self.dt))) if sound is None else sound)

    def add_final(self, picture: RgbImage) -> None:
        """Add the last frame of an episode, repeated for `FINAL_FRAME_SECONDS` in silence."""
        self.ends.append(picture)
        for _ in range(max(1, round(FINAL_FRAME_SECONDS * self.fps))):
            self.add(picture)

    def write(self, folder: Path, name: str) -> None:
        """Write `name.mp4`, and `name.png` with last frames in a column, over earlier files.

        The folder must exist, and at least one last frame (`add_final`). Sound is scaled to a peak of 0.9.

        Raises:
            HomeMjxError: A file cannot be written, such as on a full disk.
        """
        with tempfile.TemporaryDirectory(prefix="home_mjx_film_") as beside:
            wav = None
            if self.sample_rate:
                wav = Path(beside) / "sound.wav"
                media.write_wav(wav, np.concatenate(self.sounds, axis=-1), self.sample_rate)
            media.write_mp4(folder / f"{name}.mp4", np.stack(self.frames), self.fps, wav)
        media.write_png(folder / f"{name}.png", compose_sheet([[end] for end in self.ends]))
