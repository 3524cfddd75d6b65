"""The tools, one module each: ``tool(services)`` makes it, and ``PLACE`` is its place in the list.

Tools with ``WRITES`` write files that the user keeps; a server offers them only if it is started with
``--enable-write``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from irsim.common.lazy import module_names

if TYPE_CHECKING:
    from mcp.server.mcpserver.tools import Tool

    from irsim_mcp.services import Services

__all__ = ["make_tools"]


def make_tools(services: Services, *, writing: bool) -> list[Tool]:
    """Make all tools, in the order of their places; those with ``WRITES`` only if the server writes."""
    modules = [import_module(f"{__name__}.{name}") for name in module_names(__name__)]
    offered = [module for module in modules if writing or not getattr(module, "WRITES", False)]
    return [module.tool(services) for module in sorted(offered, key=lambda module: module.PLACE)]
