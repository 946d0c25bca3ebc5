"""`python -m frbcli` is `frb`."""

from frbcli.cli.main import main

main()
