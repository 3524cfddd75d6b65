"""Kept episodes: ``python -m tests.benchmarks.reference.kept NAME`` prints the lines of a table, as ``gunzip -c`` does.

The file of a table (``NAME.csv.gz``) has one line per episode, with all numbers in full precision. Its bytes follow
from its lines. Everything that reads or writes such a file does so here. The pages and the leaderboard are made from
the lines, so both can be made again, and checked, without a simulation.
"""

from __future__ import annotations

import csv
import gzip
import io
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from irsim.benchmarks.report.markdown import SHOWN
from irsim.benchmarks.summary import KEYS
from irsim.common.hashing import digest
from irsim.results.benchmark import EpisodeRow

__all__ = [
    "FOLDER",
    "Line",
    "cells_of",
    "columns_of",
    "episode_of",
    "is_kept",
    "kept_lines",
    "kept_text",
    "source_of",
    "write",
]

FOLDER = Path(__file__).parent
Line = Mapping[str, str]
"""Column -> cell of an episode."""
_OUTCOMES = ("success", "collision", "timeout")
"""Metrics that follow from the outcome."""
_COUNTS = ("seed", "steps", "unreachable", "human_contacts")
_TIMES = ("sim_time", "time_limit")
_NAMES = ("left", "jumped")
_ALWAYS = ("scenario", "policy", "seed", "outcome", "steps", *_TIMES)
_FACTS = (*_ALWAYS, "unreachable", "human_contacts", *_NAMES, "lost")
_EMPTY = ("", "0")
"""Cells of an episode without a value or an incident: a column of such cells is left out."""


def columns_of(lines: Sequence[Line]) -> list[str]:
    """The columns of a file: facts, metrics that pages show, and the engine, as far as a line has a value."""
    every = (*_FACTS, *(key for key in KEYS if key in SHOWN and key not in _OUTCOMES), "engine")
    return [key for key in every if key in _ALWAYS or any(line.get(key, "") not in _EMPTY for line in lines)]


def cells_of(episode: EpisodeRow, policy: str, engine: str) -> dict[str, str]:
    """The cells of an episode.

    Args:
        episode: The episode.
        policy: Name of its policy in the table.
        engine: Identity of the engine that ran it.
    """
    values: dict[str, Any] = {key: getattr(episode, key) for key in _FACTS if key != "policy"}
    values |= {key: ";".join(values[key]) for key in _NAMES}
    values |= {f"{role}_{key}": value for role, own in episode.roles.items() for key, value in own.items()}
    values |= episode.metrics | {"policy": policy, "engine": engine}
    return {
        key: "" if value is None else value if isinstance(value, str) else repr(value) for key, value in values.items()
    }


def episode_of(line: Line, behavior: str) -> EpisodeRow:
    """The episode of a line: values that no page shows are unknown.

    Args:
        line: The line.
        behavior: Its policy as text.
    """
    facts: dict[str, Any] = {key: int(line.get(key) or 0) for key in _COUNTS}
    facts |= {key: float(line.get(key) or 0.0) for key in _TIMES}
    facts |= {key: [name for name in line.get(key, "").split(";") if name] for key in _NAMES}
    metrics = {key: float(line[key]) if line.get(key) else None for key in KEYS}
    if line["outcome"] in _OUTCOMES:
        metrics |= {key: float(line["outcome"] == key) for key in _OUTCOMES}
    return EpisodeRow(
        scenario=line["scenario"], behavior=behavior, outcome=line["outcome"], failures={},  # type: ignore[arg-type]
        lost=line.get("lost") or None, metrics=metrics, **facts,
    )  # fmt: skip


def is_whole(line: Line) -> bool:
    """Whether a line has all that its page shows; lines of suites v1 have four metrics only."""
    return "time_limit" in line


def kept_text(name: str) -> str:
    """The lines of a table as text, with the head."""
    return gzip.decompress(_path(name).read_bytes()).decode()


def kept_lines(name: str) -> list[dict[str, str]]:
    """The lines of a table."""
    return list(csv.DictReader(io.StringIO(kept_text(name))))


def write(name: str, head: Sequence[str], lines: Iterable[Line]) -> None:
    """Write the file of a table.

    Args:
        name: Name of the table.
        head: The columns.
        lines: The lines; other columns of theirs are left out.
    """
    text = io.StringIO()
    rows = csv.DictWriter(text, head, extrasaction="ignore", lineterminator="\n")
    rows.writeheader()
    rows.writerows(lines)
    _path(name).write_bytes(gzip.compress(text.getvalue().encode(), 9, mtime=0))


def source_of(name: str, what: str = "All episodes") -> str:
    """The sentence of a page that says where its episodes are.

    Args:
        name: Name of the table.
        what: Words for its lines.
    """
    where = f"`{_path(name).relative_to(FOLDER.parents[2]).as_posix()}` of the repository"
    lines = f"whose lines (`python -m tests.benchmarks.reference.kept {name}`) have SHA-256"
    return f"{what}: {where}, {lines} `{digest(kept_text(name))}`."


def is_kept(name: str) -> bool:
    """Whether a table has a file."""
    return _path(name).exists()


def _path(name: str) -> Path:
    return FOLDER / f"{name}.csv.gz"


if __name__ == "__main__":
    sys.stdout.write(kept_text(sys.argv[1]))
