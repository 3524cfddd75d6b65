"""Recorded runs: folders ``<workspace>/.irsim/runs/<id>`` with everything that happened in an episode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irsim.runs.files import RunError
    from irsim.runs.reading import Run, list_runs, open_run

__all__ = ["Run", "RunError", "list_runs", "open_run"]


def __getattr__(name: str) -> Any:
    """The names above, without NumPy for those who only look after the folders."""
    if name == "RunError":
        from irsim.runs.files import RunError

        return RunError
    if name in __all__:
        import irsim.runs.reading

        return getattr(irsim.runs.reading, name)
    raise AttributeError(f"module 'irsim.runs' has no attribute {name!r}")
