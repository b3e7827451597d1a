"""Files appear in their folder only when all of them are done."""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def moved_when_done(out: Path) -> Iterator[Path]:
    """A folder to write to, whose files are moved to `out` at the end; not after an error."""
    with tempfile.TemporaryDirectory(prefix="home_mjx_demo_") as folder:
        yield Path(folder)
        out.mkdir(parents=True, exist_ok=True)
        for file in sorted(Path(folder).iterdir()):
            shutil.move(str(file), out / file.name)
