"""A compiled house as a full MuJoCo model with its meshes and textures.

`home_mjx.scene_compile` exports `export_mjcf` and `to_mjcf`.
"""
