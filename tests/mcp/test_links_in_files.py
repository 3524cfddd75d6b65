"""Links in place of the files that files of the workspace name: maps, their pictures, pictures of robots, policies."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from tests.mcp.swapping import Swap, swapping
from tests.mcp.test_links import CODES, SHOWN, SITE, Place

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX"),
]
PLACES = (
    "rooms", "rooms/site.yaml", "rooms/maps", "rooms/maps/site.yaml", "rooms/maps/site.png", "rooms/car.png", "net.npz",
)  # fmt: skip


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Place:
    return Place(tmp_path_factory.mktemp("named") / "workspace")


CALLS: dict[str, tuple[str, dict[str, Any]]] = {
    "validate": ("validate", {"path": "rooms/site.yaml"}),
    "compare": ("validate", {"text": SITE.replace("maps/", "rooms/maps/"), "base": "rooms/site.yaml"}),
    "write": ("validate_new", {"text": SITE, "path": "rooms/new.yaml"}),
    "draw": ("snapshot", {"path": "rooms/site.yaml", "check": True, "seed": 1, "steps": 0, **SHOWN}),
    "run": ("run", {"path": "rooms/site.yaml", "seed": 1, "steps": 3, "policy": "net.npz"}),
    "benchmark": (
        "benchmark",
        {"files": {"a": "rooms/site.yaml"}, "policies": ["{name: net.npz}"], "seeds": [1], "steps": 2},
    ),
}


@pytest.mark.rotates(4)
@pytest.mark.parametrize("first", [False, True], ids=["file", "link"])
@pytest.mark.parametrize("call", CALLS)
def test_links_in_place_of_named_files_lead_nowhere(place: Place, call: str, first: bool) -> None:
    seen = []
    for what in PLACES:
        task, arguments = CALLS[call]
        if task == "benchmark":
            arguments = {**arguments, "log": place.log}
        with swapping(Swap(place.root / what, place.root.with_name("aside"), place.double.folder / what), first=first):
            answer = place.do(task, **arguments)
        if answer.partition(" ")[0] not in CODES and not answer.startswith(("{", "null")):
            seen.append((what, answer))
        if "spied" in answer or place.double.changes():
            seen.append((what, sorted(place.double.changes())))
            place.double.reset()
    assert not seen
