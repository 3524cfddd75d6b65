"""A log of the episodes of a benchmark, each written as soon as it is done, which survives an interruption.

The first line of the file is the result without episodes; each further line is an episode, its place in the order, and
a digest of both and of the first line, so that an episode which was changed or comes from another log is noticed.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from irsim.benchmarks.incidents import incident_messages
from irsim.benchmarks.pairs import pairs_of, ranks_of
from irsim.benchmarks.summary import grouped_notes, notes_of, perturbation_notes, protocols_of, rows_of, summaries_of
from irsim.common.files import write_atomically
from irsim.common.hashing import digest
from irsim.common.records import ContentError, read_json
from irsim.common.text import clean
from irsim.episodes.opening import UNOPENED
from irsim.results.benchmark import BenchmarkResult, EpisodeRow
from irsim.runs.files import RunError, refusal, unreadable

__all__ = ["Log", "check_places", "in_order", "logged", "with_episodes"]

_FLAGS = os.O_WRONLY | os.O_APPEND | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)


class Log:
    """An open log file.

    A write error does not end the benchmark: what does not fit is kept and written as soon as there is room again.

    Args:
        file: The file, which is replaced if it exists.
        head: The result without episodes.
        known: Episodes that an earlier log of the same benchmark holds, by their places.

    Raises:
        RunError: The file cannot be written.
    """

    def __init__(self, file: str | Path, head: BenchmarkResult, known: Mapping[int, EpisodeRow] | None = None) -> None:
        self._lock, self._open = threading.Lock(), True
        self._waiting, self._head = b"", head.model_dump_json()
        lines = [self._head, *(_line(self._head, number, row) for number, row in sorted((known or {}).items()))]
        try:
            write_atomically(Path(file), "".join(f"{line}\n" for line in lines))
            self._descriptor = os.open(file, _FLAGS)
        except OSError as error:
            raise refusal(file, error) from None

    @staticmethod
    def known(file: str | Path, head: BenchmarkResult) -> tuple[BenchmarkResult, dict[int, EpisodeRow]]:
        """The result without episodes and the episodes of an earlier log of the same benchmark, by their places.

        A log from before engines had an identity is gone on with, and the result then names none, either.

        Raises:
            RunError: The log cannot be read, or belongs to another benchmark or another engine.
        """
        if not Path(file).exists():
            return head, {}
        old, episodes = _read(file)
        if not old.engine:
            head = head.model_copy(update={"engine": ""})
        elif old.engine != head.engine:
            raise RunError(
                "other-benchmark",
                f"the episodes of {str(file)!r} are of engine {clean(old.engine, 20)}, and this is {head.engine}",
                "start again in another folder: a source that decides numbers has changed, and results do not mix",
            )
        if old != head:
            raise RunError(
                "other-benchmark",
                f"{str(file)!r} is the log of another benchmark or of another version",
                "start again in another folder, or with the arguments and files of the first start",
            )
        return head, episodes

    def add(self, number: int, episode: EpisodeRow) -> None:
        """Write an episode; may be called from any thread.

        Args:
            number: Place of the episode in the order.
            episode: The episode.
        """
        line = _line(self._head, number, episode).encode() + b"\n"
        with self._lock:
            if self._open:
                self._waiting += line
                self._write()

    def __enter__(self) -> Log:
        """Return the log."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the file."""
        with self._lock:
            self._write()
            self._open = False
            with suppress(OSError):
                os.close(self._descriptor)

    def _write(self) -> None:
        """Write what is waiting, from the byte on at which the last attempt has ended."""
        with suppress(OSError):
            while self._waiting:
                self._waiting = self._waiting[os.write(self._descriptor, self._waiting) :]


def logged(file: str | Path) -> BenchmarkResult:
    """Read the result of the episodes in a log.

    Raises:
        RunError: The file cannot be read, or is not a log of a benchmark.
    """
    head, episodes = _read(file)
    try:
        return with_episodes(head, [episodes[number] for number in sorted(episodes)])
    except (LookupError, ArithmeticError):
        raise unreadable(f"the first line of {str(file)!r} has been changed") from None


def check_places(known: Mapping[int, EpisodeRow], plan: Sequence[tuple[str, str, int]]) -> None:
    """Check that each known episode has the scenario, behavior and seed that its place in the order has.

    Raises:
        RunError: One has others.
    """
    for number, one in known.items():
        if not 0 <= number < len(plan) or (one.scenario, one.behavior, one.seed) != plan[number]:
            raise unreadable(f"episode {number} of the log is not one of this benchmark: it has seed {one.seed}")


def in_order(file: str | Path, episodes: Sequence[EpisodeRow]) -> str:
    """The text of the log of a finished benchmark, with its episodes in order.

    Args:
        file: The log.
        episodes: All episodes, in order.

    Raises:
        RunError: The file cannot be read.
    """
    try:
        head = Path(file).read_text(encoding="utf-8").partition("\n")[0]
    except OSError as error:
        raise refusal(file, error) from None
    return "".join(f"{line}\n" for line in (head, *(_line(head, number, row) for number, row in enumerate(episodes))))


def _read(file: str | Path) -> tuple[BenchmarkResult, dict[int, EpisodeRow]]:
    """The result without episodes, and the episodes by their places."""
    try:
        lines = Path(file).read_bytes().split(b"\n")[:-1]  # a killed process may have left half a line
        head = BenchmarkResult.model_validate_json(lines[0])
        items = [read_json(line) for line in lines[1:]]
        episodes = {int(item["number"]): EpisodeRow.model_validate(item["episode"]) for item in items}
    except OSError as error:
        raise refusal(file, error) from None
    except (ValueError, LookupError, TypeError, OverflowError, ContentError):
        raise unreadable(f"{str(file)!r} is not a log of a benchmark") from None
    first = lines[0].decode()
    for number, line in enumerate(lines[1:], 2):
        place = int(items[number - 2]["number"])
        if line.decode() != _line(first, place, episodes[place]):
            what = f"line {number} of {str(file)!r} has been changed: it does not have the digest of its episode"
            raise RunError("unreadable-run", what, "delete that line, and --resume runs its episode again")
    return head, episodes


def _line(head: str, number: int, episode: EpisodeRow) -> str:
    row = episode.model_dump_json()
    own = digest(f"{head}\n{number}\n{row}")[:16]
    return f'{{"number": {number}, "episode": {row}, "digest": "{own}"}}'


def with_episodes(head: BenchmarkResult, episodes: Sequence[EpisodeRow]) -> BenchmarkResult:
    """A copy of a result with its episodes and with the rows and notes that follow from them."""
    protocols = protocols_of(head.scenarios)
    summaries = summaries_of(episodes, head.scenarios, head.behaviors, protocols, head.groups)
    notes = perturbation_notes(head.perturbed) + notes_of(episodes, head)
    notes += grouped_notes(head.unequal)
    unopened = {
        name: finding.message for name in head.warnings for finding in head.warnings[name] if finding.code == UNOPENED
    }
    notes += grouped_notes(unopened)
    rows = rows_of(summaries, head.behaviors, head.random, head.certain)
    pairs = pairs_of(summaries, head.behaviors, head.random, head.certain)
    changes = {
        "episodes": list(episodes),
        "rows": rows,
        "pairs": pairs,
        "ranks": ranks_of(rows, pairs),
        "notes": notes,
        "incidents": incident_messages(episodes),
    }
    return head.model_copy(update=changes)
