"""Thin views of the environments for other ecosystems: `gymnasium`, `brax`."""
