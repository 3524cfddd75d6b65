"""Notices that the clock of the system was set, by comparing it with the time since the system was started.

Files that are dated in the future then are dated now, so that the next one is the newest.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

__all__ = ["CLOCK_TOLERANCE_S", "clock_was_set", "date_now"]

CLOCK_TOLERANCE_S = 60.0
"""Difference of two clocks [s] that counts as none."""
_TICK_NS = 1_000_000_000
"""Time [ns] by which dates of files may be late: systems date them by a clock that stands still in between."""
_BOOT_ID = Path("/proc/sys/kernel/random/boot_id")


def clock_was_set(mark: Path) -> bool:
    """Whether the clock was set since the last call with this file, which keeps both times.

    It is not known, and taken for no, at the first call and after a restart of the system.
    """
    boot, up, now = _boot(), _seconds_up(), time.time()
    was_set = False
    with suppress(OSError, ValueError):
        boot_then, up_then, then = mark.read_text(encoding="utf-8").split("\n")[:3]
        between = up - float(up_then)
        was_set = boot_then == boot and between >= 0 and not abs(now - float(then) - between) < CLOCK_TOLERANCE_S
    with suppress(OSError):
        descriptor = os.open(mark, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_NOFOLLOW", 0), 0o600)
        with os.fdopen(descriptor, "w", encoding="utf-8") as file:
            file.write(f"{boot}\n{up}\n{now}\n")
    return was_set


def date_now(files: Sequence[Path], was_set: bool = False) -> None:
    """Date files now that are dated in the future or, if the clock was set, all files; their order stays.

    Args:
        files: The files, the latest first.
        was_set: Whether the clock was set.
    """
    now = time.time_ns()
    limit = 0 if was_set else now + round(CLOCK_TOLERANCE_S * 1e9)
    for rank, file in enumerate(files):
        with suppress(OSError):
            if os.lstat(file).st_mtime_ns > limit:
                os.utime(file, ns=(now - _TICK_NS - rank,) * 2)


def _boot() -> str:
    """The name of this start of the system; empty where the system provides no such name."""
    with suppress(OSError, ValueError):
        return _BOOT_ID.read_text(encoding="ascii").strip()
    return ""


def _seconds_up() -> float:
    """Time since the system was started, on Linux including the time for which it slept [s]."""
    clock = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if clock is None else time.clock_gettime(clock)
