"""What pytest needs of the files of tests, which have no packages."""

from collections import Counter
from pathlib import Path


def test_every_file_of_tests_has_its_own_name():
    """Of two with one name pytest imports the first for both, and fails unless old byte code hides it."""
    names = Counter(path.name for path in Path(__file__).parent.rglob("test_*.py"))
    assert [name for name, count in names.items() if count > 1] == []
