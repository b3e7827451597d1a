"""Shaders of colour images, which register themselves, and the textures, lights and glass that they share.

Every module of this folder is imported with the package, so a new shader is one new file.
"""

import importlib
import pkgutil

for _module in pkgutil.iter_modules(__path__, f"{__name__}."):
    importlib.import_module(_module.name)
