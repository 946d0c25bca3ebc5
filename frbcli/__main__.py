"""`python -m frbcli` is `frb`."""

import os
import sys

# Python puts the current folder first, where modules of any name may lie. The package itself may as well: a copy of the
# project that is not installed.
if not sys.flags.safe_path and sys.path[0] != os.path.dirname(os.path.dirname(os.path.abspath(__file__))):
    del sys.path[0]

from frbcli.cli.process import main

main()
