"""Run ``irsim`` so that it is killed, or finds the disk full, at one of its writes.

``python interrupted.py PHASE NUMBER HOW irsim-arguments…``. Writes, new names of files and new folders are counted from
the start (``run``) or from the moment when the result is written (``report``). At the one with the given number the
process kills itself before it (``before``), after half of its bytes (``half``), or after it (``after``); with ``full``
every write from there on fails as on a full disk. ``count`` prints at the end how many there were.
"""

from __future__ import annotations

import atexit
import errno
import os
import signal
import sys
import threading
from pathlib import Path
from typing import Any

phase, number, how = sys.argv[1], int(sys.argv[2]), sys.argv[3]
sys.argv[:4] = ["irsim"]
counts = {"run": 0, "report": -1}
lock = threading.Lock()


def counted(name: str) -> None:
    """Count the calls of a function of ``os``."""
    plain = getattr(os, name)

    def call(*words: Any, **options: Any) -> Any:
        if name in ("write", "writev") and words[0] < 3:
            return plain(*words, **options)
        with lock:  # a recorder writes in a thread of its own
            if name == "replace" and Path(words[1]).name == "results.json":
                counts["report"] = 0
            for each in counts:
                counts[each] += counts[each] >= 0
            now = counts[phase]
        if how == "full" and now >= number > 0 and name in ("write", "writev"):
            raise OSError(errno.ENOSPC, "No space left on device")
        if how in ("before", "half") and now == number:
            if how == "half" and name == "write":
                plain(words[0], bytes(words[1])[: len(words[1]) // 2])
            elif how == "half" and name == "writev":
                data = b"".join(words[1])
                os.write.__wrapped__(words[0], data[: len(data) // 2])  # type: ignore[attr-defined]
            os.kill(os.getpid(), signal.SIGKILL)
        try:
            return plain(*words, **options)
        finally:  # also after a folder that exists already
            if how == "after" and now == number:
                os.kill(os.getpid(), signal.SIGKILL)

    call.__wrapped__ = plain  # type: ignore[attr-defined]
    setattr(os, name, call)


for function in ("write", "writev", "replace", "mkdir"):
    counted(function)
if how == "count":
    atexit.register(lambda: print(counts["run"], counts["report"]))

from irsim.cli import main  # noqa: E402

main()
