"""Starts the server of the package that ``pyproject.toml`` beside this file names."""

from irsim_mcp.__main__ import main

main()
