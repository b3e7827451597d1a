"""Images, videos and sound files for display."""

from home_mjx.viewer.pictures.floor_map import draw_map
from home_mjx.viewer.pictures.media import write_mp4, write_png, write_wav, write_webm
from home_mjx.viewer.pictures.pictures import (
    add_caption,
    colour_depth,
    colour_ids,
    compose_sheet,
    draw_waveform,
    enlarge,
)
from home_mjx.viewer.pictures.top_view import Marker, TopView

__all__ = [
    "Marker",
    "TopView",
    "add_caption",
    "colour_depth",
    "colour_ids",
    "compose_sheet",
    "draw_map",
    "draw_waveform",
    "enlarge",
    "write_mp4",
    "write_png",
    "write_wav",
    "write_webm",
]
