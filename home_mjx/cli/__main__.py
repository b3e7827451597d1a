"""Entry point of `python -m home_mjx.cli`."""

import sys

from home_mjx.cli import main

if __name__ == "__main__":
    sys.exit(main())
