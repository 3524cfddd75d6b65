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
from pathlib import Path
from statistics import median

import yaml

from tests.speed.scenes import SCENES

_HEAD = ("scene", "what", "per second", "each", "peer, per second", "ratio", "memory")
_WHAT = {"step": "step", "act": "step", "batch": "step", "plan": "plan"}
_WORKER = Path(__file__).with_name("worker.py")
_QUIET = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg", "PYTHONWARNINGS": "ignore"}
_TIMEOUT_S = 900.0


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


def _duration(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms" if seconds >= 1e-3 else f"{seconds * 1e6:.3g} µs"


def _rate(seconds: float) -> str:
    rate = 1.0 / seconds
    return f"{rate:,.0f}" if rate >= 100 else f"{rate:.3g}"


def line(name: str, given: argparse.Namespace, folder: Path) -> str:
    """The line of a scene, measured in turns with both interpreters, so that a slow moment of the machine hits both."""
    scene, ours, theirs, memory_mb = SCENES[name], list[float](), list[float](), 0.0
    for _ in range(given.rounds):
        answer = measure(name, given.python, folder, given.seconds)
        ours.append(answer["step_s"])
        memory_mb = max(memory_mb, answer["memory_mb"])
        if given.peer is not None and scene.mode != "batch":  # which the other simulator does not have
            theirs.append(measure(name, given.peer, folder, given.seconds)["step_s"])
    step_s, rate, ratio = median(ours), _rate(median(ours)), ""
    if scene.mode == "batch":  # where robots or beams per second count
        count, unit = (scene.rays, "beams") if scene.rays else (scene.agents, "robots")
        rate = f"{count * scene.worlds / step_s / 1e6:.3g} M {unit}"
    if theirs:
        times = median(their / our for their, our in zip(theirs, ours, strict=True))
        ratio = f"{times:,.0f}" if times >= 10 else f"{times:.2g}"
    peer = _rate(median(theirs)) if theirs else ""
    cells = name, _WHAT.get(scene.mode, "frame"), rate, _duration(step_s), peer, ratio, f"{memory_mb:.0f} MB"
    return f"| {' | '.join(cells)} |"


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
                print(line(name, given, Path(folder)), flush=True)
            except RuntimeError as error:
                failed += 1
                print(error, file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
