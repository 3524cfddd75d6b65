"""The processes that compute for the studio: one reads texts, one runs them; a newer run ends the one before."""

from __future__ import annotations

import base64
import json
import os
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from irsim.common.child import ONE_THREAD, Child, python
from irsim.studio.feed import FAILED, Feed

__all__ = ["TooSlow", "Worker"]

_ENVIRONMENT = {"MPLBACKEND": "Agg", **ONE_THREAD}
_START_S = 20.0
"""Time that starting a process may take, in addition to the time of its job [s]."""


class TooSlow(Exception):
    """A job that took longer than it may, or whose process has died; the message says which."""


class Worker:
    """A process that does one job at a time, and is started anew after one that takes too long.

    Args:
        root: Folder of the studio, outside of which it reads no files.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._turn = threading.Lock()
        self._child = self._start()

    def ask(self, task: str, seconds: float, **job: Any) -> Any:
        """The result of a job; others wait for their turn meanwhile.

        Args:
            task: Name of the task.
            seconds: Longest time that it may take [s].
            **job: Arguments of the task.

        Raises:
            TooSlow: It took longer, or the process has died.
            ValueError: The job failed; the message says why.
        """
        with self._turn:
            return self._answer(task, seconds, job, None)

    def run(self, feed: Feed, seconds: float, **job: Any) -> None:
        """Do runs, whose frames and results go to a feed, which is closed at their end; returns at once."""
        threading.Thread(target=self._run, args=(feed, seconds, job), daemon=True).start()

    def stop(self) -> None:
        """End the job that is being done, if any, by ending the process; the next one has a new process."""
        self._child.kill()

    def close(self) -> None:
        """End the process."""
        self._child.end()

    def _run(self, feed: Feed, seconds: float, job: dict[str, Any]) -> None:
        with self._turn:
            try:
                self._answer("run", seconds, job, feed.put)
            except (TooSlow, ValueError) as error:
                feed.put(FAILED, str(error).encode())
            finally:
                feed.close()

    def _start(self) -> Child:
        child = Child(python("irsim.studio.worker"), cwd=self._root, env=os.environ | _ENVIRONMENT)
        child.send(json.dumps({"task": "warm", "root": str(self._root)}).encode())
        self._waiting = 1
        return child

    def _answer(
        self, task: str, seconds: float, job: Mapping[str, Any], put: Callable[[int, bytes], None] | None
    ) -> Any:
        if self._child.process.poll() is not None:
            self._child.end()
            self._child = self._start()
        line = json.dumps({"task": task, "root": str(self._root), **job}).encode()
        end = time.monotonic() + seconds + _START_S
        if not self._child.send(line):
            raise TooSlow("the process that computes has died; try again")
        while True:
            received = self._child.receive(max(0.0, end - time.monotonic()))
            if not received:
                self._child.kill()
                why = f"it takes more than {seconds:g} s" if received is None else "it was stopped"
                raise TooSlow(why)
            message = json.loads(received)
            if "frame" in message:
                if put is not None:
                    put(message["frame"], base64.b64decode(message["content"]))
            elif self._waiting:
                self._waiting -= 1  # the answer to the job that only loads
            elif "error" in message:
                raise ValueError(message["error"])
            else:
                return message["result"]
