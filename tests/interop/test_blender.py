"""Blender reads stages that we write: where bodies are over time, which meshes and cameras there are.

``nox -s nightly`` installs Blender (bpy 4.5, 947 MB from PyPI, Python 3.11) and runs them. With a Python that has it:
``IRSIM_NIGHTLY=1 IRSIM_BPY=/path/of/python pytest -m nightly tests/interop/test_blender.py``.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
from pathlib import Path

import pytest

from irsim.bridges.export.export import export_run
from irsim.bridges.recorded import recorded_states
from tests.bridges.scenes import record_stage

pytestmark = [
    pytest.mark.nightly,
    pytest.mark.slow(30),
    pytest.mark.skipif(
        os.environ.get("IRSIM_NIGHTLY") != "1", reason="Blender (bpy) is 947 MB: nox -s nightly runs it"
    ),
]
BLENDER = """
import bpy, json, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=sys.argv[1], import_visible_only=False)
scene, found = bpy.context.scene, {}
for step in json.loads(sys.argv[2]):
    scene.frame_set(step)
    for name in json.loads(sys.argv[3]):
        placed = bpy.data.objects[name].matrix_world
        found[f"{name}/{step}"] = [*placed.translation, placed.to_euler().z]
found["meshes"] = sorted(item.name for item in bpy.data.objects if item.type == "MESH")
found["cameras"] = sorted(item.name for item in bpy.data.objects if item.type == "CAMERA")
wall = bpy.data.objects["Map"]
found["flat"] = max(abs(abs(f.normal.z) - round(abs(f.normal.z))) for f in wall.data.polygons)
print("FOUND" + json.dumps(found))
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return record_stage(tmp_path_factory.mktemp("usd"))


def test_blender_reads_a_run(run, tmp_path: Path) -> None:
    export_run(run, tmp_path / "run.usdc")
    (tmp_path / "read.py").write_text(BLENDER)
    steps, names = [0, 12, 30], ["robot_1", "walker"]
    command = [os.environ["IRSIM_BPY"], "read.py", "run.usdc", json.dumps(steps), json.dumps(names)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
    assert "FOUND" in done.stdout, done.stdout + done.stderr
    answer = json.loads(done.stdout.split("FOUND")[1].splitlines()[0])
    for state in recorded_states(run):
        for name, index in zip(names, (0, 5), strict=True):
            if state.step in steps and math.isfinite(state.pose[index, 0]):
                x, y, z, yaw = answer[f"{name}/{state.step}"]
                assert (x, y, z) == pytest.approx((*state.pose[index, :2], 0), abs=1e-5)
                assert math.remainder(yaw - state.pose[index, 2], math.tau) == pytest.approx(0, abs=1e-5)
    assert "Map" in answer["meshes"]
    assert answer["cameras"] == ["Overview", "Top"]
    assert answer["flat"] < 1e-6
