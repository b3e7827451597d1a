"""A small Habitat dataset, written by hand: two rooms, a chair, a cupboard with a door, and their descriptors."""

import json
from pathlib import Path
from typing import Any

from gltf_files import BOXES, GltfFile

CONFIG = "flat.scene_dataset_config.json"
ARCHITECTURE = tuple(name for name in BOXES if name not in ("Dining_Table.001", "chair"))
REGIONS = [
    {"label": "kitchen", "poly_loop": [[0, 0, 0], [4, 0, 0], [4, 0, 4], [0, 0, 4]]},
    {"label": "living room", "poly_loop": [[4, 0, 0], [8, 0, 0], [8, 0, 4], [4, 0, 4]]},
]
CUPBOARD = """<robot name="cupboard"><link name="root"/>
<joint name="fix" type="fixed"><origin rpy="1.5707963 0 0" xyz="0 0.5 0"/>
<parent link="root"/><child link="body"/></joint>
<link name="body"><visual><geometry><box size="0.6 0.4 1"/></geometry></visual></link>
<joint name="hinge" type="revolute"><origin xyz="-0.3, 0.2, 0"/><parent link="body"/><child link="door"/>
<axis xyz="0 0 2"/><limit lower="-0.5" upper="1.5" effort="1" velocity="1"/></joint>
<link name="door"><visual><origin xyz="0.3 0.01 0"/><geometry><box size="0.6 0.02 1"/></geometry></visual></link>
<joint name="rail" type="prismatic"><origin xyz="0 0 0"/><parent link="body"/><child link="drawer"/>
<axis xyz="0 1 0"/><limit lower="0" upper="0.3" effort="1" velocity="1"/></joint>
<link name="drawer"><visual><geometry><mesh filename="none.glb"/></geometry></visual>
<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link></robot>"""


def write(path: Path, content: Any) -> Path:
    """Write text, or JSON, to a file whose folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def stage_file() -> GltfFile:
    """The walls, floor and ceiling of `gltf_files.two_rooms`."""
    file = GltfFile()
    for name in ARCHITECTURE:
        file.box(name, *BOXES[name])
    return file


def write_dataset(root: Path, **scene: Any) -> Path:
    """Write the dataset, with entries of its scene instance replaced; return its configuration."""
    stage_file().write(write(root / "stages" / "flat.glb", ""))
    chair = GltfFile()
    chair.box("seat", (1, 0, 0), (1.5, 0.9, 0.4))  # 0.5 x 0.9 x 0.4 m, its origin beside it
    chair.write(write(root / "objects" / "chair_1.glb", ""))
    write(root / "configs" / "flat.stage_config.json", {"render_asset": "../stages/flat.glb", "up": [0, 1, 0]})
    write(root / "configs" / "chair_1.object_config.json", {"render_asset": "../objects/chair_1.glb", "semantic_id": 7})
    write(root / "urdf" / "cupboard" / "cupboard.urdf", CUPBOARD)
    lights = {"lamp": {"type": "point", "position": [2, 2.3, 2], "intensity": 2.0, "color": [1, 0.5, 0.5]}}
    lights |= {"dark": {"type": "point", "position": [2, 2, 2], "intensity": -1.0}}
    write(root / "configs" / "day.lighting_config.json", {"lights": lights})
    semantics = {"classes": [{"id": 7, "name": "beanbag"}], "region_annotations": REGIONS}
    write(root / "flat.semantic_config.json", semantics)
    content = {
        "stage_instance": {"template_name": "flat"},
        "object_instances": [{"template_name": "chair_1", "translation": [2, 0.45, 1]}],
        "articulated_object_instances": [{"template_name": "cupboard", "translation": [6, 0, 0.3]}],
        "default_lighting": "day",
        "semantic_scene_instance": "map",
        "navmesh_instance": "none",
    }
    write(root / "scenes" / "flat_0.scene_instance.json", {**content, **scene})
    config = {
        "stages": {"paths": {".json": ["configs"]}},
        "objects": {"paths": {".json": ["configs/*"]}},
        "articulated_objects": {"paths": {".urdf": ["urdf/*/", "../outside/*.urdf"]}},
        "light_setups": {"paths": {".json": ["configs"]}},
        "scene_instances": {"paths": {".json": ["scenes"]}},
        "semantic_scene_descriptor_instances": {"map": "flat.semantic_config.json"},
    }
    return write(root / CONFIG, config)
