"""Print how fast irsim is: ``python -m tests.speed [SCENE ...] [--peer PYTHON]``."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tests.speed.measure import Row, compare
from tests.speed.scenes import SCENES

_HEAD = ("scene", "what", "per second", "each", "peer, per second", "ratio", "memory")
_WHAT = {"step": "step", "act": "step", "batch": "step", "plan": "plan"}


def _duration(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms" if seconds >= 1e-3 else f"{seconds * 1e6:.3g} µs"


def _rate(seconds: float) -> str:
    rate = 1.0 / seconds
    return f"{rate:,.0f}" if rate >= 100 else f"{rate:.3g}"


def _totals(row: Row) -> str:
    """Robots and beams per second of a batch, which is what counts there."""
    count = row.scene.agents if not row.scene.rays else row.scene.rays
    unit = "robots" if not row.scene.rays else "beams"
    return f"{count * row.scene.worlds / row.step_s / 1e6:.3g} M {unit}"


def line(row: Row) -> tuple[str, ...]:
    """The cells of one line of the table."""
    return (
        row.name,
        _WHAT.get(row.scene.mode, "frame"),
        _totals(row) if row.scene.mode == "batch" else _rate(row.step_s),
        _duration(row.step_s),
        "" if row.peer_s is None else _rate(row.peer_s),
        "" if row.ratio is None else f"{row.ratio:,.0f}" if row.ratio >= 10 else f"{row.ratio:.2g}",
        f"{row.memory_mb:.0f} MB",
    )


def main(arguments: list[str] | None = None) -> int:
    """Print a table in Markdown, line by line as the scenes are measured."""
    parser = argparse.ArgumentParser(prog="python -m tests.speed", description="Print how fast irsim is.")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"default: all of {', '.join(SCENES)}")
    parser.add_argument("--peer", help="interpreter with another simulator of the same interface, such as ir-sim 2.12")
    parser.add_argument("--python", default=sys.executable, help="interpreter with irsim; default: this one")
    parser.add_argument("--rounds", type=int, default=3, help="times that each scene is measured (default: 3)")
    parser.add_argument("--seconds", type=float, default=0.3, help="stepping time of each of 3 repeats (default: 0.3)")
    given = parser.parse_args(arguments)
    unknown = [name for name in given.scenes if name not in SCENES]
    if unknown:
        parser.error(f"unknown scene {unknown[0]!r}; the scenes are {', '.join(SCENES)}")
    print(f"| {' | '.join(_HEAD)} |\n|{'---|' * len(_HEAD)}")
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in given.scenes or SCENES:
            try:
                row = compare(name, given.python, given.peer, Path(folder), rounds=given.rounds, seconds=given.seconds)
            except RuntimeError as error:
                failed += 1
                print(error, file=sys.stderr)
                continue
            print(f"| {' | '.join(line(row))} |", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
