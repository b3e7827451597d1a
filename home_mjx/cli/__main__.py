"""`python -m home_mjx.cli`."""

import sys

from home_mjx.cli import main

sys.exit(main())
