"""The installed version of irsim."""

from __future__ import annotations

from functools import cache

__all__ = ["version"]


@cache
def version() -> str:
    """The version as the package's metadata have it, such as ``0.1.0``."""
    from importlib.metadata import version as version_of

    return version_of("irsim-mcp")
