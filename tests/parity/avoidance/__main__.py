"""Compare how robots avoid each other and walls with ir-sim 2.12: ``python -m tests.parity.avoidance``.

Without options, the starts of `families.py` are run and compared with the kept reference of ir-sim 2.12. ``--write``
keeps ours as a reference, too: do so after a change that is meant to change motion. ``--peer PYTHON`` runs those starts
of ir-sim 2.12 that its reference lacks; all of them take half an hour of processor time.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from tests.parity.avoidance.families import BEHAVIORS, PEER_BEHAVIORS, groups
from tests.parity.avoidance.results import FOLDER, Key, Outcomes, Pool, exact_losses, pools, read, write

WORKER = Path(__file__).with_name("worker.py")
OURS, PEER = FOLDER / "ours.csv", FOLDER / "peer.csv"
PASSES = (1, 6, 11, 21, 51)
"""Starts of each group that come before all others; what one pass found is kept if the next is interrupted."""
QUIET = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}


def run(python: str, behaviors: tuple[str, ...], known: Path, jobs: int, *options: str) -> dict[Key, Outcomes]:
    """Run in several processes the groups that a file lacks, and return all."""
    with tempfile.TemporaryDirectory() as folder:
        parts = [Path(folder) / f"{k}.csv" for k in range(jobs)]
        processes = []
        for k, part in enumerate(parts):
            part.write_text(known.read_text(encoding="utf-8") if known.exists() else "", encoding="utf-8")
            command = [python, str(WORKER), str(part), "--behaviors", ",".join(behaviors), "--share", f"{k}/{jobs}"]
            processes.append(subprocess.Popen([*command, *options], env={**os.environ, **QUIET}))
        failed = [process.wait() for process in processes]
        outcomes = read(parts)
    if any(failed):
        raise SystemExit(f"{WORKER.name} failed with {python}")
    return outcomes


def table(counted: dict[tuple[str, ...], Pool], head: str) -> str:
    """A table in Markdown of pooled starts."""
    columns = (
        f"{head} | starts | ours | 2.12 | difference, points (95 %) | only 2.12 | contacts | 2.12 | between steps"
        " | 2.12 | s | 2.12"
    )
    lines = [f"| {columns} |", "|" + "---|" * (columns.count("|") + 1)]
    for name, pool in counted.items():
        point, low, high = pool.interval
        both = len(pool.seconds) or 1
        mine, theirs = (sum(pair[side] for pair in pool.seconds) / both for side in (0, 1))
        cells = (
            *name, pool.starts, f"{100 * pool.ours / pool.starts:.1f} %", f"{100 * pool.peer / pool.starts:.1f} %",
            f"{point:+.1f} ({low:+.1f} to {high:+.1f})", pool.only_peer, pool.contacts, pool.peer_contacts,
            pool.between, pool.peer_between, f"{mine:.1f}", f"{theirs:.1f}",
        )  # fmt: skip
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def report(ours: dict[Key, Outcomes], peer: dict[Key, Outcomes]) -> str:
    """All tables."""
    names: list[tuple[str, Callable[[Key], tuple[str, ...]]]] = [
        ("behavior | drive", lambda key: key[:2]),
        ("behavior | drive | step", lambda key: key[:3]),
        ("behavior | drive | family", lambda key: (*key[:2], key[3])),
    ]
    wanted = sum(len(group.starts) for group in groups(PEER_BEHAVIORS))
    there = sum(len(theirs.letters) for theirs in peer.values())
    parts = [f"The reference of 2.12 has {there} of {wanted} starts; the tables compare starts that both have."]
    parts += [table(pools(ours, peer, name), head) for head, name in names]
    lost = exact_losses(ours, peer)
    parts.append(f"Exact starts that 2.12 solves and we do not ({len(lost)}):\n\n" + _list_losses(lost))
    return "\n\n".join(parts)


def _list_losses(lost: list[tuple[Key, str]]) -> str:
    """A line for each behavior, drive and family: its cases, spellings and steps."""
    lines: dict[tuple[str, ...], list[str]] = {}
    for key, what in lost:
        lines.setdefault((key[0], key[1], key[3]), []).append(
            f"{' '.join(filter(None, key[4:]))} at {key[2]} s ({what})"
        )
    return "\n".join(f"- {' '.join(name)}: {', '.join(cases)}" for name, cases in lines.items())


def main(arguments: list[str] | None = None) -> int:
    """Run what is missing and print the tables."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.parity.avoidance", description="Compare avoidance with ir-sim 2.12."
    )
    parser.add_argument("--peer", help="interpreter with PyPI's ir-sim 2.12 and pyrvo: run what its reference lacks")
    parser.add_argument("--write", action="store_true", help="keep our results as the reference")
    parser.add_argument("--kept", action="store_true", help="print the tables of the kept references; run nothing")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    given = parser.parse_args(arguments)
    FOLDER.mkdir(exist_ok=True)
    if given.peer:
        for starts in PASSES:
            write(PEER, run(given.peer, PEER_BEHAVIORS, PEER, given.jobs, "--starts", str(starts)))
    if given.kept:
        ours = read([OURS])
    else:
        ours = run(sys.executable, BEHAVIORS, Path(os.devnull), given.jobs)
        if given.write:
            write(OURS, ours)
    print(report(ours, read([PEER])))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
