"""A log of the episodes of a benchmark, each written as soon as it is done, which survives an interruption.

The first line of the file is the result without episodes; each further line is an episode and its place in the order.
"""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from irsim.benchmarks.incidents import incident_messages
from irsim.benchmarks.summary import notes_of, perturbation_notes, rows_of
from irsim.results.benchmark import BenchmarkResult, EpisodeRow
from irsim.runs.files import refusal, unreadable

__all__ = ["Log", "logged", "with_episodes"]

_FLAGS = os.O_CREAT | os.O_TRUNC | os.O_WRONLY | os.O_APPEND | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)


class Log:
    """An open log file; a write error ends the log, not the benchmark.

    Args:
        file: The file, which is replaced if it exists.
        head: The result without episodes.

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
        """Write an episode; may be called from any thread.

        Args:
            number: Place of the episode in the order.
            episode: The episode.
        """
        self._add(f'{{"number": {number}, "episode": {episode.model_dump_json()}}}')

    def __enter__(self) -> Log:
        """Return the log."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the file."""
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
    """Read the result of the episodes in a log.

    Raises:
        RunError: The file cannot be read, or is not a log of a benchmark.
    """
    try:
        lines = Path(file).read_bytes().split(b"\n")[:-1]  # a killed process may have left half a line
        head = BenchmarkResult.model_validate_json(lines[0])
        found = [json.loads(line) for line in lines[1:]]
        episodes = {int(item["number"]): EpisodeRow.model_validate(item["episode"]) for item in found}
    except OSError as error:
        raise refusal(file, error) from None
    except (ValueError, LookupError, TypeError):
        raise unreadable(f"{str(file)!r} is not a log of a benchmark") from None
    return with_episodes(head, [episodes[number] for number in sorted(episodes)])


def with_episodes(head: BenchmarkResult, episodes: Sequence[EpisodeRow]) -> BenchmarkResult:
    """A copy of a result with its episodes and with the rows and notes that follow from them."""
    rows = rows_of(episodes, head.scenarios, head.behaviors, head.random)
    notes = perturbation_notes(head.perturbed) + notes_of(episodes, head.random, head.seeds)
    found = {"episodes": list(episodes), "rows": rows, "notes": notes, "incidents": incident_messages(episodes)}
    return head.model_copy(update=found)
