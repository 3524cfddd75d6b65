"""Runs scenes in fresh processes, alternately with irsim and with another simulator that has its interface."""

from __future__ import annotations

import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import yaml

from tests.speed.scenes import SCENES, Scene

__all__ = ["Row", "compare", "measure"]

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
