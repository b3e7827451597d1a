"""Surfaces of a house: material rows, their gloss, and reflection planes for sound."""

from collections.abc import Sequence
from dataclasses import dataclass

from home_mjx.scene_compile.architecture.frame import HouseFrame
from home_mjx.scene_compile.architecture.mirror_planes import build_reflection_planes
from home_mjx.scene_compile.architecture.shell import BuildingShell
from home_mjx.scene_compile.lighting.gloss import gloss_table
from home_mjx.scene_compile.materials.surface import SurfaceRows, material_table
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import MaterialTable, Planes
from home_mjx.schema.lighting import Gloss


@dataclass(frozen=True)
class HouseSurfaces:
    """Optical and acoustic properties of a house's surfaces.

    Attributes:
        materials: Material rows; those of the shell are first.
        first_row: First row of each object.
        gloss: Gloss of each row.
        planes: Rectangles that reflect sound.
    """

    materials: MaterialTable
    first_row: Sequence[int]
    gloss: Gloss
    planes: Planes


def build_surfaces(frame: HouseFrame, shell: BuildingShell, objects: Sequence[PlacedObject]) -> HouseSurfaces:
    """Build the material rows of the shell and of all objects; objects with equal materials share rows."""
    rows = SurfaceRows()
    rows.add(shell.surfaces)
    first = [rows.add(o.surfaces) for o in objects]
    return HouseSurfaces(
        materials=material_table(rows.surfaces),
        first_row=first,
        gloss=gloss_table(rows.surfaces, objects, frame.house.models, first),
        planes=build_reflection_planes(shell, frame.rooms),
    )
