"""A process that runs episodes: one task per line of standard input, one result per line of standard output.

It ends with its standard input, at once, so it never outlives whoever started it.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading

__all__ = ["main"]


def main() -> None:
    """Do tasks until there are no more."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever prints, does not print into the answers
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(lines,), daemon=True).start()
    from irsim.benchmarks.episode import Task, run_task

    while True:
        line = lines.get()
        try:
            answer = json.dumps({"result": run_task(Task.of_data(json.loads(line)))})
        except Exception as error:
            answer = json.dumps({"error": f"{type(error).__name__}: {error}"})
        answers.write(answer + "\n")
        answers.flush()


def _listen(lines: queue.SimpleQueue[bytes]) -> None:
    for line in sys.stdin.buffer:
        lines.put(line)
    os._exit(0)
