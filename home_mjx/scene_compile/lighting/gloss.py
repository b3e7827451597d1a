"""Gloss of surfaces, from the MTL file or else the kind of material, and detection of mirrors."""

from collections.abc import Mapping, Sequence

import numpy as np

from home_mjx.scene_compile.materials.surface import SurfaceMaterial
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.house import BoxNode, Material, Mesh
from home_mjx.schema.lighting import Gloss

SPECULAR_MAX = 0.2  # MTL files have up to 1 in addition to a full diffuse colour, which violates energy conservation
# Specular reflectance and Blinn-Phong exponent by kind of material, for slots whose MTL has neither.
KIND_GLOSS: Mapping[str, tuple[float, float]] = {
    "ceramic": (0.12, 120.0),
    "facing stone": (0.04, 30.0),
    "glass": (0.2, 300.0),
    "laminate": (0.06, 60.0),
    "leather": (0.06, 25.0),
    "linoleum": (0.04, 30.0),
    "metal": (0.3, 80.0),
    "plastic": (0.06, 50.0),
    "tile": (0.1, 90.0),
    "wood": (0.05, 40.0),
}


def gloss_table(
    surfaces: Sequence[SurfaceMaterial],
    objects: Sequence[PlacedObject],
    models: Mapping[str, Mesh],
    first: Sequence[int],
) -> Gloss:
    """Return the gloss of a house's material rows: from an object's MTL if that has `Ks` and `Ns`, else by their kind.

    Set `mirror` for the reflecting slots of mirrors. `surfaces` are by row, `models` meshes by key, and `first` has
    the first row of each object.
    """
    gloss = Gloss.matt(len(surfaces))
    for row, item in enumerate(surfaces):
        gloss.specular[row], gloss.shininess[row] = KIND_GLOSS.get(item.kind, (0.0, 1.0))
    for item, start in zip(objects, first, strict=True):
        if not isinstance(item.node, BoxNode):
            for slot, material in enumerate(models[item.node.model_key].materials):
                _from_mtl(gloss, start + slot, material)
            gloss.mirror[start + np.array(_mirrors(item), int)] = True
    return gloss


def _from_mtl(gloss: Gloss, row: int, material: Material) -> None:
    """Set a row in place to `Ks` (at most `SPECULAR_MAX`) and `Ns` (clipped to 1..1000) if a material has both."""
    if material.specular is not None and material.shininess is not None:
        gloss.specular[row] = np.minimum(material.specular, SPECULAR_MAX)
        gloss.shininess[row] = np.clip(material.shininess, 1.0, 1000.0)


def _mirrors(item: PlacedObject) -> list[int]:
    """Return the reflecting slots of a mirror; slots with a texture or opacity below 1 do not reflect.

    Of the others, those with `mirror` in their name reflect, else the largest. Empty for other objects.
    """
    if item.info.coarse != "mirror":
        return []
    plain = [i for i, s in enumerate(item.surfaces) if s.opacity == 1 and not s.texture]
    named = [i for i in plain if "mirror" in item.surfaces[i].name.lower()]
    if named or not plain:
        return named
    edge = item.triangles[:, 1:] - item.triangles[:, :1]
    area = np.bincount(item.model.slot, np.linalg.norm(np.cross(edge[:, 0], edge[:, 1]), axis=-1), len(item.surfaces))
    return [max(plain, key=lambda i: area[i])]
