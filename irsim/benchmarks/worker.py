"""A process that runs episodes: a job and its seeds per line of standard input, one result per line of standard output.

It ends immediately when its standard input is closed, so it never outlives the process that started it.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading

__all__ = ["READY", "main"]

READY = b"ready\n"
"""The first line, which says that tasks can be sent."""


def main() -> None:
    """Run tasks until standard input is closed."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what user modules print must not mix with the answers
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(lines,), daemon=True).start()
    from irsim.benchmarks.episode import Job
    from irsim.benchmarks.together import run_together

    answers.write(READY.decode())
    answers.flush()
    while True:
        data = json.loads(lines.get())
        try:
            for result in run_together(Job.of_data(data["job"]), data["seeds"]):
                answers.write(json.dumps({"result": result}) + "\n")
                answers.flush()
        except Exception as error:
            answers.write(json.dumps({"error": f"{type(error).__name__}: {error}"}) + "\n")
            answers.flush()


def _listen(lines: queue.SimpleQueue[bytes]) -> None:
    for line in sys.stdin.buffer:
        lines.put(line)
    os._exit(0)
