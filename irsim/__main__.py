"""``python -m irsim``: the command line."""

from irsim.cli import main

main()
