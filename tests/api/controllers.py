"""Controllers in a module of their own, as other processes import them."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any


def wander(env: Any) -> list[float]:
    """Drive on at a random turn rate."""
    return [0.6, float(env.rng.normal(0.0, 0.5))]


class Counting:
    """Turns more with each of its steps, which it remembers.

    In a folder it leaves the number of its process, and waits there for another process after the first episode.
    """

    def __init__(self, folder: Path | None = None, processes: int = 1) -> None:
        self.steps, self.folder, self.processes = 0, folder, processes

    def __call__(self, env: Any) -> list[float]:
        self.steps += 1
        if self.folder is not None:
            (self.folder / str(os.getpid())).touch()
            end = time.monotonic() + 30
            while env.seed and len(list(self.folder.iterdir())) < self.processes and time.monotonic() < end:
                time.sleep(0.05)
        return [0.5, 0.01 * self.steps]


def failing(env: Any) -> list[float]:
    """Fail in the third step of one seed."""
    if env.seed == 3 and env.time > 0.15:
        raise ZeroDivisionError("no way")
    return [0.5, 0.0]


def interrupted(env: Any) -> list[float]:
    """Interrupt the program that called irsim, as Ctrl-C does."""
    os.kill(os.getpid(), signal.SIGINT)
    return [0.5, 0.0]
