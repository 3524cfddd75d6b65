"""Run ``irsim`` so that Ctrl-C is pressed in it, as at a terminal, at one of its writes or at an import.

``python ctrl_c.py MOMENT irsim-arguments…``. A number counts writes, new names of files and new folders; a word is the
name of a module whose import is interrupted. All processes of the group get the signal.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from typing import Any

moment = sys.argv[1]
sys.argv[:2] = ["irsim"]
count = 0
lock = threading.Lock()


def press() -> None:
    """Press Ctrl-C."""
    os.killpg(0, signal.SIGINT)


def counted(name: str) -> None:
    """Count the calls of a function of ``os``."""
    plain = getattr(os, name)

    def call(*words: Any, **options: Any) -> Any:
        global count
        if name != "write" or words[0] > 2:
            with lock:
                count += 1
            if str(count) == moment:
                press()
        return plain(*words, **options)

    setattr(os, name, call)


class Importing:
    """Presses Ctrl-C when a module is about to be imported."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        """Find nothing."""
        if name == moment:
            press()


for function in ("open", "write", "replace", "mkdir", "rename", "link"):
    counted(function)
sys.meta_path.insert(0, Importing())  # type: ignore[arg-type]

from irsim.cli import main  # noqa: E402

main()
