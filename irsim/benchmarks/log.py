"""Episodes on disk as soon as they are done, for whoever wants to keep what a benchmark had that was stopped.

The first line of the file is the result without episodes; each further one is an episode and its place in the order.
"""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from irsim.benchmarks.summary import notes_of, rows_of
from irsim.results.benchmark import BenchmarkResult, EpisodeRow
from irsim.runs.files import refusal, unreadable

__all__ = ["Log", "logged", "with_episodes"]

_FLAGS = os.O_CREAT | os.O_TRUNC | os.O_WRONLY | os.O_APPEND | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)


class Log:
    """The file, open. What the system refuses to write ends the log, not the benchmark.

    Args:
        file: Where; what was there is gone.
        head: The result, without episodes.

    Raises:
        RunError: The file cannot be written.
    """

    def __init__(self, file: str | Path, head: BenchmarkResult) -> None:
        self._lock, self._open = threading.Lock(), True
        try:
            self._descriptor = os.open(file, _FLAGS, 0o600)
        except OSError as error:
            raise refusal(file, error) from None
        self._add(head.model_dump_json())

    def add(self, number: int, episode: EpisodeRow) -> None:
        """Write an episode, whose place in the order is ``number``, down; from any thread."""
        self._add(f'{{"number": {number}, "episode": {episode.model_dump_json()}}}')

    def __enter__(self) -> Log:
        """Nothing."""
        return self

    def __exit__(self, *error: object) -> None:
        """Write no more."""
        with self._lock:
            self._open = False
            with suppress(OSError):
                os.close(self._descriptor)

    def _add(self, text: str) -> None:
        line = text.encode() + b"\n"
        with self._lock:
            try:
                self._open = self._open and os.write(self._descriptor, line) == len(line)
            except OSError:
                self._open = False


def logged(file: str | Path) -> BenchmarkResult:
    """The result of the episodes in a log.

    Raises:
        RunError: It is no log.
    """
    try:
        lines = Path(file).read_bytes().split(b"\n")[:-1]  # whoever was killed may have left half of a line
        head = BenchmarkResult.model_validate_json(lines[0])
        found = [json.loads(line) for line in lines[1:]]
        episodes = {int(item["number"]): EpisodeRow.model_validate(item["episode"]) for item in found}
    except OSError as error:
        raise refusal(file, error) from None
    except (ValueError, LookupError, TypeError):
        raise unreadable(f"{str(file)!r} is no log of a benchmark") from None
    return with_episodes(head, [episodes[number] for number in sorted(episodes)])


def with_episodes(head: BenchmarkResult, episodes: Sequence[EpisodeRow]) -> BenchmarkResult:
    """A result with episodes, in their order, and all that follows from them."""
    rows = rows_of(episodes, head.scenarios, head.behaviors, head.random)
    notes = notes_of(episodes, head.random, head.seeds)
    return head.model_copy(update={"episodes": list(episodes), "rows": rows, "notes": notes})
