"""Compiled house as a full MuJoCo model with meshes and textures.

`home_mjx.scene_compile` exports `export_mjcf` and `to_mjcf`.
"""

from typing import TYPE_CHECKING

from home_mjx import moved

if not TYPE_CHECKING:  # type checkers report missing names by themselves
    __getattr__ = moved.attributes_of(__name__)
