"""Files of arrays on disk: entries with checksums, and dataclasses as flat arrays."""
