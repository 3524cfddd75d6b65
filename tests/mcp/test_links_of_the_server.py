"""Links that change at every opening of a file of the real server over standard input and of its workers."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from irsim_mcp.sandbox import Workspace
from tests.mcp.conftest import ROOM, Wire
from tests.mcp.hooked import ROOT, tell
from tests.mcp.test_links import SWAPPED, Place, swap_of

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX"),
]
ROOMS = {"scenario_path": "rooms/room.yaml"}
REQUESTS: dict[str, tuple[str, dict[str, Any]]] = {
    "validate": ("validate_scenario", ROOMS),
    "compare": ("validate_scenario", {"scenario_yaml": ROOM, "base": "rooms/room.yaml"}),
    "write": ("write_scenario", {"path": "rooms/new.yaml", "yaml": ROOM, "overwrite": True}),
    "draw": ("render_snapshot", {**ROOMS, "size_px": 200}),
    "run": ("run_episode", {**ROOMS, "policy": "net.npz", "seed": 1, "max_steps": 3}),
    "inspect": ("inspect_run", {"run_id": "RUN"}),
    "draw a run": ("render_snapshot", {"run_id": "RUN", "step": 3, "size_px": 200}),
    "export a file": ("export_run", {"run_id": "RUN", "to": "csv"}),
    "export a folder": ("export_run", {"run_id": "RUN", "to": "colmap"}),
    "benchmark": ("benchmark", {"scenarios": ["rooms/room.yaml"], "policies": ["net.npz"], "seeds": 1, "max_steps": 2}),
    "get a job": ("get_job", {"job_id": "job-123456"}),
    "read a run": ("resources/read", {"uri": "irsim://runs/RUN/trace.csv"}),
    "complete": (
        "completion/complete",
        {
            "ref": {"type": "ref/resource", "uri": "irsim://runs/{run_id}/{artifact}{?from_step,to_step,every,robot,offset}"},
            "argument": {"name": "run_id", "value": ""},
        },
    ),
}  # fmt: skip


class Hooked(Wire):
    """A server whose processes swap what a file says."""

    def __init__(self, place: Place) -> None:
        self.control = place.root.with_name("control")
        self.control.touch()
        self.program = ("tests.mcp.hooked", str(self.control))
        self.number = 1
        super().__init__(place.root, "--enable-write", cwd=ROOT)

    def answer(self, method: str, arguments: dict[str, Any]) -> str:
        """The answer to a request, as text."""
        self.number += 1
        if "/" in method:
            self.ask(method, self.number, **arguments)
        else:
            self.call(method, self.number, **arguments)
        while (message := self.receive()).get("id") != self.number:
            pass
        return json.dumps(message)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Place:
    return Place(tmp_path_factory.mktemp("server") / "workspace")


@pytest.fixture
def server(place: Place) -> Iterator[Hooked]:
    server = Hooked(place)
    yield server
    server.close()


@pytest.mark.slow(20)
@pytest.mark.rotates(14)
@pytest.mark.parametrize("request_name", REQUESTS)
def test_a_server_is_led_nowhere_by_links_that_come_and_go(place: Place, server: Hooked, request_name: str) -> None:
    method, arguments = json.loads(json.dumps(REQUESTS[request_name]).replace("RUN", place.run_id))
    assert "result" in server.answer("validate_scenario", ROOMS)
    seen, swaps = [], 0
    for what in SWAPPED:
        swap = swap_of(place, what)
        tell(server.control, swap)
        answer = server.answer(method, arguments)
        swaps += tell(server.control, None)
        swap.restore()
        if "spied" in answer or "internal-error" in answer or place.double.changes():
            seen.append((what, answer[:300], sorted(place.double.changes())))
            place.double.reset()
    assert not seen
    assert swaps > len(SWAPPED)
    assert '"isError": false' in server.answer("validate_scenario", ROOMS)
    assert Workspace(place.root).runs()
