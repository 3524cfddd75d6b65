"""Whether processes run, and waiting until they have ended; on Linux."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path


def runs(pid: int) -> bool:
    """Whether a process runs; one that has ended but has not been waited for does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (OSError, IndexError):
        return False


def wait_until_gone(pids: Iterable[int], seconds: float = 20.0) -> None:
    """Wait until processes have ended; they must within that time."""
    pids, end = list(pids), time.monotonic() + seconds
    while any(map(runs, pids)) and time.monotonic() < end:
        time.sleep(0.02)
    assert [pid for pid in pids if runs(pid)] == []
