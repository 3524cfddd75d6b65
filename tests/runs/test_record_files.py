"""A record keeps its own files: its map, whatever is drawn later; and reading a record executes none of them."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.options.registry import CUSTOM_BEHAVIORS
from irsim.runs import RunError, open_run
from irsim.runs.inspection import inspect_run
from irsim.runs.replay.data import pack_run
from irsim.runs.resimulation import resimulate

SCENARIO = """\
world: {width: 10, height: 10, obstacle_map: pictures/rooms.png, time_limit: 12}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [1, 5, 0]
    goal: [9, 5, 0]
    behavior: {name: dash}
    sensors: [{name: lidar2d, range_max: 5, number: 9}]
"""

OWN = """\
import irsim

@irsim.register_behavior("diff", "test_record_turns")
def turns(ego_object, external_objects, **options):
    import numpy as np
    return np.array([[0.5], [0.2]])
"""


def draw(path: Path, *, blocked: bool) -> None:
    pixels = np.full((50, 50), 255, np.uint8)
    if blocked:
        pixels[20:30, 20:30] = 0
    Image.fromarray(pixels).save(path)


@pytest.fixture
def recorded(workspace: Path) -> str:
    """A run that ends at the block of a map, in the folder ``kept``."""
    (workspace / "pictures").mkdir()
    draw(workspace / "pictures" / "rooms.png", blocked=True)
    (workspace / "scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    result = irsim.run("scenario.yaml", seed=0, record="kept")
    assert result.outcome == "collision"
    return "kept"


def closest(run: str) -> Any:
    return inspect_run(run, view="closest").rows


@pytest.mark.parametrize("change", ["another", "empty", "gone", "moved"])
def test_a_run_is_looked_at_with_the_map_that_it_had(workspace: Path, recorded: str, change: str) -> None:
    rows, page = closest(recorded), pack_run(open_run(recorded)).data
    picture = workspace / "pictures" / "rooms.png"
    if change == "another":
        Image.fromarray(np.eye(50, dtype=np.uint8) * 255).save(picture)
    elif change == "empty":
        draw(picture, blocked=False)
    elif change == "gone":
        picture.unlink()
    else:
        (workspace / "scenario.yaml").unlink()
        (workspace / "pictures").rename(workspace / "elsewhere")
    assert closest(recorded) == rows
    assert pack_run(open_run(recorded)).data == page
    env = resimulate(open_run(recorded))
    assert env.simulation.collided[0]
    env.end(ending_time=0.0)


def test_both_files_of_a_ros_map_are_kept(workspace: Path) -> None:
    draw(workspace / "plan.png", blocked=True)
    text = "image: plan.png\nresolution: 0.2\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    (workspace / "plan.yaml").write_text(text, encoding="utf-8")
    scenario = SCENARIO.replace("pictures/rooms.png", "{name: ros, path: plan.yaml}")
    (workspace / "scenario.yaml").write_text(scenario, encoding="utf-8")
    irsim.run("scenario.yaml", seed=0, record="kept")
    rows = closest("kept")
    for name in ("plan.png", "plan.yaml"):
        (workspace / name).unlink()
    assert closest("kept") == rows


@pytest.mark.parametrize(
    "named", [["map-0.png"], [["rooms.png", "../secret.png"]], [["a", "map-1.png"]], 7, [[1, 2, 3]]]
)
def test_names_of_kept_maps_lead_nowhere_else(recorded: str, named: Any) -> None:
    path = open_run(recorded).folder / "run.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "maps": named}))
    with pytest.raises(RunError, match="unreadable-run"):
        closest(recorded)


def test_modules_of_a_run_are_not_imported_to_look_at_it(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (workspace / "turning.py").write_text(OWN, encoding="utf-8")
    monkeypatch.syspath_prepend(workspace)
    text = SCENARIO.replace("obstacle_map: pictures/rooms.png, ", "").replace("name: dash", "name: test_record_turns")
    result = irsim.run(text=text, seed=0, steps=30, imports=["turning"], record="kept")
    monkeypatch.delitem(sys.modules, "turning")
    monkeypatch.delitem(CUSTOM_BEHAVIORS.functions, ("diff", "test_record_turns"))
    (workspace / "turning.py").write_text("raise SystemExit('imported')\n", encoding="utf-8")
    assert inspect_run("kept", view="rows").rows
    assert pack_run(open_run("kept")).data
    env = resimulate(open_run("kept"), 20)
    trace = open_run("kept").trace()
    np.testing.assert_array_equal(env.simulation.pose, trace.pose[20])
    np.testing.assert_allclose(env.simulation.ranges, np.minimum(trace.ranges["robot_0/0"][20], 5), rtol=1e-6)
    assert (env.time, result.steps) == (2.0, 30)
    env.end(ending_time=0.0)


def test_two_that_record_into_one_folder_do_not_mix(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = (
        SCENARIO.replace("obstacle_map: pictures/rooms.png, ", "").replace("9, 5", f"9, {y}") for y in "46"
    )
    monkeypatch.setattr(
        "irsim.runs.recorder._make_empty_folder", lambda folder: folder.mkdir(exist_ok=True) or folder.resolve()
    )
    irsim.run(text=first, seed=0, record="kept")
    before = {path.name: path.read_bytes() for path in (workspace / "kept").iterdir()}
    with pytest.raises(RunError, match=r"file-exists: .*kept' already contains a run. Fix: name another folder"):
        irsim.run(text=second, seed=0, record="kept")
    assert {path.name: path.read_bytes() for path in (workspace / "kept").iterdir()} == before
