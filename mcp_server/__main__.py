"""``python -m mcp_server`` in a checkout: the same as ``irsim-mcp``."""

from irsim_mcp.__main__ import main

main()
