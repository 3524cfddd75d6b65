"""Recorded runs to audit, and ways to change them."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.common.archives import pack_arrays
from irsim.results.audit import RunAudit
from irsim.runs.audit.audit import audit_runs

TEMPLATES = Path(__file__).resolve().parents[3] / "templates"

DISCS = """\
world: {width: 10, height: 10, step_time: 0.5, time_limit: 10, collision_mode: MODE, contacts: CONTACTS}
robot:
  - {name: left, kinematics: {name: diff}, shape: {name: circle, radius: 0.5}, state: [2, 5, 0], goal: [9, 5, 0],
     vel_max: [1, 1], vel_min: [-1, -1], behavior: {name: dash}}
  - {name: right, kinematics: {name: diff}, shape: {name: circle, radius: 0.5}, state: [5.5, 5, 3.141592653589793],
     goal: [1, 5, 0], vel_max: [1, 1], vel_min: [-1, -1], behavior: {name: dash}}
"""
"""Two discs drive towards each other. Their rims are 2.5 m apart and approach at 2 m/s: they meet at 1.25 s."""


@pytest.fixture
def record(workspace: Path) -> Callable[..., Path]:
    """A function that runs a scenario and returns the folder of its record."""

    def run(text: str, **options: Any) -> Path:
        irsim.run(text=text, seed=0, record="kept", **options)
        return workspace / "kept"

    return run


def discs(mode: str = "stop", contacts: str = "swept") -> str:
    """The scenario :data:`DISCS`."""
    return DISCS.replace("MODE", mode).replace("CONTACTS", contacts)


def audited(run: str | Path) -> RunAudit:
    """The audit of one run."""
    return audit_runs([run]).runs[0]


def codes(result: RunAudit) -> set[str]:
    """Codes of all findings and problems."""
    return {finding.code for finding in result.findings} | {problem.code for problem in result.problems}


def change_json(path: Path, change: Callable[[Any], None]) -> None:
    """Change the data of a JSON file in place."""
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    path.write_text(json.dumps(data), encoding="utf-8")


def change_piece(folder: Path, change: Callable[[dict[str, Any], dict[str, Any]], None]) -> None:
    """Change ``piece.json`` and the arrays of the first piece of a run in place."""
    path = folder / "trace-0000.npz"
    with zipfile.ZipFile(path) as archive:
        about = json.loads(archive.read("piece.json"))
        names = [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]
    with np.load(path) as content:
        arrays = {name: content[name].copy() for name in names}
    change(about, arrays)
    path.write_bytes(pack_arrays(arrays))
    with zipfile.ZipFile(path, "a", zipfile.ZIP_STORED) as archive:
        archive.writestr("piece.json", json.dumps(about))
