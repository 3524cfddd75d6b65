"""Recorded runs: folders ``<workspace>/.irsim/runs/<id>`` with the trace, events and result of an episode."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.runs.files import RunError
    from irsim.runs.reading import Run, list_runs, open_run

__all__ = ["Run", "RunError", "list_runs", "open_run"]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "Run": "irsim.runs.reading",
        "RunError": "irsim.runs.files",
        "list_runs": "irsim.runs.reading",
        "open_run": "irsim.runs.reading",
    },
)
