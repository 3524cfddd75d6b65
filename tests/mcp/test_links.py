"""Links that change between check and use: nothing outside the workspace is read or written, whatever is swapped when.

A worker's tasks run in this process while the workspace is held, as the worker holds it, with a hook that swaps a place
of the workspace for a link to its double outside before each call that opens, makes or moves a file.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from irsim.policies.networks import save_network
from irsim_mcp import job
from irsim_mcp.job_errors import error_data
from irsim_mcp.limits import ServerLimits, scenario_limits
from irsim_mcp.sandbox import Workspace
from tests.mcp import swapping as swapper
from tests.mcp.conftest import ROOM
from tests.mcp.swapping import Double, Swap, swapping
from tests.policies.networks.examples import go_to_goal

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX"),
]
LIMITS = ServerLimits()
MAPPED = ROOM.replace("world: {", "world: {obstacle_map: map.png, ")
SITE = ROOM.replace("world: {", "world: {obstacle_map: {name: ros, path: maps/site.yaml}, ").replace(
    "name: rover", "name: rover\n    description: car.png"
)
"""A scenario that names a picture, and a map of ROS, which names one."""
ROS_MAP = "{image: site.png, resolution: 0.1, origin: [0, 0, 0], negate: 0, occupied_thresh: 0.65, free_thresh: 0.2}\n"
CODES = {
    "path-outside-workspace", "file-not-found", "not-a-file", "invalid-scenario", "unknown-run", "unreadable-run",
    "file-access", "file-exists", "unreadable", "unknown-policy", "policy-file", "unknown-artifact",
}  # fmt: skip
"""How a call may fail when a place is not what it was."""


class Place:
    """A workspace with a scenario, its map, a policy, a run and a job, and its double."""

    def __init__(self, root: Path) -> None:
        self.root = root
        (root / "rooms").mkdir(parents=True)
        (root / "exports").mkdir()
        Image.new("L", (80, 60), 255).save(root / "rooms" / "map.png")
        (root / "rooms" / "room.yaml").write_text(MAPPED, encoding="utf-8")
        (root / "rooms" / "site.yaml").write_text(SITE, encoding="utf-8")
        (root / "rooms" / "maps").mkdir()
        (root / "rooms" / "maps" / "site.yaml").write_text(ROS_MAP, encoding="utf-8")
        Image.new("L", (80, 60), 255).save(root / "rooms" / "maps" / "site.png")
        Image.new("RGB", (12, 12), "red").save(root / "rooms" / "car.png")
        save_network(root / "net.npz", go_to_goal())
        self.workspace = Workspace(root)
        self.run_id = json.loads(self.do("run", path="rooms/room.yaml", seed=1, steps=10))["run_id"]
        self.do("export", **self.exported("colmap"))
        (root / ".irsim" / "jobs" / "job-123456").mkdir(parents=True)
        self.log = str(root / ".irsim" / "jobs" / "job-123456" / "episodes.jsonl")
        self.double = Double(root, "rover", "spied")

    def do(self, task: str, **arguments: Any) -> str:
        """Do a task as a worker does, and return the text of its answer, or the code of an error and its data."""
        limits = asdict(scenario_limits(LIMITS, self.workspace.root))
        work = {"task": task, "arguments": arguments, "workspace": str(self.workspace.root), "limits": limits}
        with self.workspace.hold():
            try:
                return job._TASKS[task](work, job._Progress(lambda _: None))
            except Exception as error:
                data = error_data(error)
                return f"{data['code']} {data}"

    def exported(self, to: str) -> dict[str, Any]:
        return {"run_id": self.run_id, "to": to, "objects": "movers", "out": "exports"}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Place:
    return Place(tmp_path_factory.mktemp("links") / "workspace")


SHOWN = {"size": 200, "overlays": None, "region": None, "draw": True, "strip": None}
CALLS: dict[str, Callable[[Place], tuple[str, dict[str, Any]]]] = {
    "validate": lambda _: ("validate", {"path": "rooms/room.yaml"}),
    "compare": lambda _: ("validate", {"text": ROOM, "base": "rooms/room.yaml"}),
    "write": lambda _: ("validate_new", {"text": MAPPED, "path": "rooms/new.yaml"}),
    "draw": lambda _: ("snapshot", {"path": "rooms/room.yaml", "check": True, "seed": 1, "steps": 0, **SHOWN}),
    "run": lambda _: ("run", {"path": "rooms/room.yaml", "seed": 1, "steps": 3, "policy": "net.npz"}),
    "inspect": lambda place: ("inspect", {"run_id": place.run_id, "view": "rows", "from_step": 0, "limit": 5}),
    "draw a run": lambda place: ("run_snapshot", {"run_id": place.run_id, "steps": 3, **SHOWN}),
    "export a file": lambda place: ("export", place.exported("csv")),
    "export a folder": lambda place: ("export", place.exported("colmap")),
    "read a run": lambda place: (
        "artifact",
        {"run_id": place.run_id, "name": "trace.csv", "from_step": 0, "every": 1, "offset": 0, "most": 1000},
    ),
    "benchmark": lambda place: (
        "benchmark",
        {"files": {"a": "rooms/room.yaml"}, "policies": ["net.npz"], "seeds": [1], "steps": 2, "log": place.log},
    ),
    "result of a job": lambda place: ("logged", {"log": place.log, "to": f"{place.log}.json"}),
}
SWAPPED: dict[str, Callable[[Place], Path]] = {
    "the workspace": lambda place: Path(),
    "a folder": lambda place: Path("rooms"),
    "the scenario": lambda place: Path("rooms/room.yaml"),
    "its map": lambda place: Path("rooms/map.png"),
    "the policy": lambda place: Path("net.npz"),
    "exports": lambda place: Path("exports"),
    "an export": lambda place: Path("exports") / f"{place.run_id}.colmap",
    "records": lambda place: Path(".irsim"),
    "runs": lambda place: Path(".irsim/runs"),
    "a run": lambda place: Path(".irsim/runs") / place.run_id,
    "its data": lambda place: Path(".irsim/runs") / place.run_id / "run.json",
    "its scenario": lambda place: Path(".irsim/runs") / place.run_id / "scenario.yaml",
    "jobs": lambda place: Path(".irsim/jobs"),
    "a job": lambda place: Path(".irsim/jobs/job-123456"),
}


def swap_of(place: Place, what: str) -> Swap:
    inner = SWAPPED[what](place)
    return Swap(place.root / inner, place.root.with_name("aside"), place.double.folder / inner)


@pytest.mark.rotates(4)
@pytest.mark.parametrize("first", [False, True], ids=["file", "link"])
@pytest.mark.parametrize("call", CALLS)
def test_a_link_that_comes_and_goes_leads_nowhere(place: Place, call: str, first: bool) -> None:
    seen = []
    for what in SWAPPED:
        swap = swap_of(place, what)
        task, arguments = CALLS[call](place)
        with swapping(swap, first=first):
            answer = place.do(task, **arguments)
        if answer.partition(" ")[0] not in CODES and not answer.startswith(("{", "null")):
            seen.append((what, answer))
        if "spied" in answer or place.double.changes():
            seen.append((what, sorted(place.double.changes()), swap.count))
            place.double.reset()
    assert not seen


@contextmanager
def race(swap: Swap) -> Iterator[None]:
    """A process that swaps as fast as it can."""
    command = [sys.executable, "-IS", swapper.__file__, swap.place, swap.aside, swap.double]
    racer = subprocess.Popen(command, stdin=subprocess.PIPE)
    try:
        yield
    finally:
        racer.kill()
        racer.communicate()
        swap.restore()


def races(place: Place, call: str, number: int) -> None:
    """Calls during which another process swaps, in equal parts, each of the places."""
    for what in SWAPPED:
        task, arguments = CALLS[call](place)
        with race(swap_of(place, what)):
            answers = [place.do(task, **arguments) for _ in range(-(-number // len(SWAPPED)))]
        assert not [one for one in answers if "spied" in one or one.startswith("internal-error")], what
        assert not place.double.changes(), what


@pytest.mark.nightly
@pytest.mark.slow(15)
@pytest.mark.rotates(12)
@pytest.mark.parametrize("call", CALLS)
def test_races(place: Place, call: str) -> None:
    races(place, call, 2000 if os.environ.get("IRSIM_NIGHTLY") else 200)


def test_a_task_leaves_the_current_folder_as_it_was(place: Place, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(place.root.parent)
    task, arguments = CALLS["draw"](place)
    place.do(task, **arguments)
    assert Path.cwd() == place.root.parent
