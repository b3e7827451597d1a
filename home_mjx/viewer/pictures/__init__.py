"""Images, videos and sound files for display."""

from home_mjx.viewer.pictures.floor_map import map_picture
from home_mjx.viewer.pictures.media import write_mp4, write_png, write_wav
from home_mjx.viewer.pictures.pictures import captioned, depth_colours, enlarge, id_colours, sheet, waveform
from home_mjx.viewer.pictures.top_view import Mark, TopView

__all__ = [
    "Mark",
    "TopView",
    "captioned",
    "depth_colours",
    "enlarge",
    "id_colours",
    "map_picture",
    "sheet",
    "waveform",
    "write_mp4",
    "write_png",
    "write_wav",
]
