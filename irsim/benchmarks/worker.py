"""A process that runs episodes: a job and its seeds per line of standard input, one result per line of standard output.

It ends immediately when its standard input is closed, so it never outlives the process that started it.
"""

from __future__ import annotations

import json

from irsim.common.child import answers, lines, write_line

__all__ = ["READY", "main"]

READY = b"ready\n"
"""The first line, which says that tasks can be sent."""


def main() -> None:
    """Run tasks until standard input is closed."""
    pipe, tasks = answers(), lines()
    from irsim.benchmarks.episode import Job
    from irsim.benchmarks.together import run_together

    pipe.write(READY)
    while True:
        data = json.loads(tasks.get())
        try:
            for result in run_together(Job.of_data(data["job"]), data["seeds"]):
                write_line(pipe, {"result": result})
        except Exception as error:
            write_line(pipe, {"error": f"{type(error).__name__}: {error}"})
