"""Parsers of single files and fields of SUNCG: OBJ, MTL, materials, polygons."""
