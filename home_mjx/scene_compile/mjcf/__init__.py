"""Compiled house as a full MuJoCo model with meshes and textures.

`home_mjx.scene_compile` exports `export_mjcf` and `to_mjcf`.
"""
