"""`python -m frbcli` is `frb`."""

from frbcli.cli.process import main

main()
