"""Lets ``python -m eigenwalker`` run the command."""

import sys

from eigenwalker.cli import main

sys.exit(main())
