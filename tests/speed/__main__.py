"""Print how fast irsim is: ``python -m tests.speed [SCENE ...] [--peer PYTHON]``.

Scenes run in fresh processes, alternately with irsim and with another simulator that has its interface.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import yaml

from tests.speed.scenes import SCENES, Scene

_HEAD = ("scene", "what", "per second", "each", "peer, per second", "ratio", "memory")
_WHAT = {"step": "step", "act": "step", "batch": "step", "plan": "plan"}
_WORKER = Path(__file__).with_name("worker.py")
_QUIET = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg", "PYTHONWARNINGS": "ignore"}
_TIMEOUT_S = 900.0


@dataclass(frozen=True)
class Row:
    """A line of the table.

    Attributes:
        name: Name of the scene.
        scene: The scene.
        step_s: Processor time of one step, plan or frame [s]; of a batch, of one step of all worlds.
        peer_s: The same for the other simulator; None where it was not asked or cannot run the scene.
        ratio: Median over the rounds of the other simulator's time through ours.
        memory_mb: Largest memory of the process [MB].
    """

    name: str
    scene: Scene
    step_s: float
    peer_s: float | None
    ratio: float | None
    memory_mb: float


def measure(name: str, python: str, folder: Path, seconds: float) -> dict[str, float]:
    """Measure a scene in a fresh process.

    Args:
        name: Name of the scene.
        python: Interpreter that has the simulator.
        folder: Folder for the files of the measurement.
        seconds: Stepping time of each of several repeats [s].

    Returns:
        ``step_s``, processor time of a step [s], and ``memory_mb``.

    Raises:
        RuntimeError: The process failed; the message has the last line of its output.
    """
    scene, result = SCENES[name], folder / "result.json"
    scenario, job = folder / f"{name}.yaml", folder / "job.json"
    scenario.write_text(yaml.safe_dump(scene.build(), sort_keys=False), encoding="utf-8")
    given = {"mode": scene.mode, "steps": scene.steps, "worlds": scene.worlds, "seconds": seconds}
    job.write_text(json.dumps({**given, "file": str(scenario), "result": str(result)}), encoding="utf-8")
    result.unlink(missing_ok=True)
    command = [python, str(_WORKER), str(job)]
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, **_QUIET}, capture_output=True, text=True, timeout=_TIMEOUT_S
    )
    if not result.exists():
        said = (done.stderr or done.stdout).strip().splitlines()
        raise RuntimeError(f"{name} failed with {python}: {said[-1] if said else done.returncode}")
    answer: dict[str, float] = json.loads(result.read_text(encoding="utf-8"))
    return answer


def compare(name: str, python: str, peer: str | None, folder: Path, *, rounds: int, seconds: float) -> Row:
    """Measure a scene, alternately with two interpreters, so that a slow moment of the machine hits both.

    Args:
        name: Name of the scene.
        python: Interpreter that has irsim.
        peer: Interpreter that has the other simulator, or None. Batches are not asked of it.
        folder: Folder for the files of the measurements.
        rounds: Number of times that each is measured.
        seconds: Stepping time of each repeat [s].
    """
    scene, ours, theirs = SCENES[name], list[float](), list[float]()
    memory = 0.0
    for _ in range(rounds):
        answer = measure(name, python, folder, seconds)
        ours.append(answer["step_s"])
        memory = max(memory, answer["memory_mb"])
        if peer is not None and scene.mode != "batch":
            theirs.append(measure(name, peer, folder, seconds)["step_s"])
    ratio = median(their / our for their, our in zip(theirs, ours, strict=True)) if theirs else None
    return Row(name, scene, median(ours), median(theirs) if theirs else None, ratio, memory)


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
