"""The surfaces of a house: rows of materials for light and sound, their gloss, and the planes that mirror sound."""

from collections.abc import Sequence
from dataclasses import dataclass

from home_mjx.scene_compile.architecture.frame import Frame
from home_mjx.scene_compile.architecture.mirror_planes import build_planes
from home_mjx.scene_compile.architecture.shell import Shell
from home_mjx.scene_compile.lighting.gloss import gloss_table
from home_mjx.scene_compile.materials.surface import SurfaceRows, material_table
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import MaterialTable, Planes
from home_mjx.schema.lighting import Gloss


@dataclass(frozen=True)
class Surfaces:
    """How a house looks and sounds.

    Attributes:
        materials: Rows; those of the shell are the first.
        first_row: First row of each object.
        gloss: Of the rows.
        planes: Rectangles that mirror sound.
    """

    materials: MaterialTable
    first_row: Sequence[int]
    gloss: Gloss
    planes: Planes


def build_surfaces(frame: Frame, shell: Shell, objects: Sequence[PlacedObject]) -> Surfaces:
    """Materials of the shell and of all objects; objects with equal materials share their rows."""
    rows = SurfaceRows()
    rows.add(shell.surfaces)
    first = [rows.add(o.surfaces) for o in objects]
    return Surfaces(
        materials=material_table(rows.surfaces),
        first_row=first,
        gloss=gloss_table(rows.surfaces, objects, frame.house.models, first),
        planes=build_planes(shell, frame.rooms),
    )
