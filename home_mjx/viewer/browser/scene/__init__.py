"""House of a bank in viser's scene: meshes, instances and poses."""
