"""Files that other people made: tests marked ``foreign`` read them where they lie, outside of the project.

``IRSIM_SHARED`` names the folder that holds them in ``data/foreign``. Without it those tests are skipped; where it is,
a skipped one fails. The gate gives a file in ``IRSIM_FOREIGN_LOG``, to which each of them that ran adds its name.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest


def folder() -> Path | None:
    """The folder of foreign files; None where it is missing."""
    shared = os.environ.get("IRSIM_SHARED")
    files = Path(shared, "data", "foreign") if shared else None
    return files if files and files.is_dir() else None


@pytest.fixture(scope="session")
def foreign() -> Path:
    """The folder of foreign files; a test is skipped where it is missing."""
    files = folder()
    if files is None:
        pytest.skip("IRSIM_SHARED does not name a folder with data/foreign, which holds the foreign files")
    return files


def judge(item: pytest.Item, report: Any) -> None:
    """Make a skipped test over foreign files fail where the files are there, and write down one that ran.

    Args:
        item: The test.
        report: The report of pytest about one of its phases, which is changed in place.
    """
    if item.get_closest_marker("foreign") is None or folder() is None:
        return
    if report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid} was skipped although the foreign files are there: {report.longrepr[2]}"
    elif report.when == "call" and (log := os.environ.get("IRSIM_FOREIGN_LOG")):
        with Path(log).open("a", encoding="utf-8") as file:
            file.write(f"{item.nodeid}\n")
