"""The Model Context Protocol server of irsim: scenarios validated, drawn and simulated for agents."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

try:
    from irsim.common.installed import refuse_conflicts
except ModuleNotFoundError as error:
    raise ImportError(
        "the package 'irsim' that Python finds here is not the one of 'irsim-mcp'; PyPI's 'ir-sim' provides another of "
        "that name. Install 'irsim-mcp' into an environment of its own."
    ) from error

refuse_conflicts()

if TYPE_CHECKING:
    __version__: str

__all__ = ["__version__"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        import irsim

        return irsim.__version__
    raise AttributeError(f"module 'irsim_mcp' has no attribute {name!r}")
