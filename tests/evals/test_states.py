"""Results in a reply: held against episodes whose numbers follow from arithmetic."""

from __future__ import annotations

from typing import Any

import pytest

from tests.evals.conftest import seen, world

DRIVES = (
    "{kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}, "
    "state: [1, %d, 0], goal: [7, %d, 0]}"
)
BOX = "{name: box, shape: {name: rectangle, length: 1, width: %d}, state: [4, 6, 0]}"
TWO = f"world: {{width: 10, height: 10}}\nrobot: [{DRIVES % (3, 3)}, {DRIVES % (4, 4)}]\nobstacle: {BOX}\n"
FREE = TWO % 1  # both arrive after 5.9 s, one 1.3 m off the box
BLOCKED = TWO % 4  # the second one hits the box


@pytest.mark.parametrize(
    ("text", "keys", "reply", "problem"),
    [
        (FREE, {"measure": "arrival", "about": "arriv"}, "Both arrive after 5.9 s.", ""),
        (FREE, {"measure": "arrival", "about": "arriv"}, "Both arrive after about 6 s.", ""),  # rounded
        (FREE, {"measure": "arrival", "about": "Ziel"}, "Nach 5,9 Sekunden sind beide am Ziel.", ""),
        (FREE, {"measure": "arrival", "about": "arriv"}, "Both arrive after 7.3 s.", "7.3 s"),
        (FREE, {"measure": "arrival", "about": "arriv"}, "Both arrive.", "no number there"),
        (FREE, {"measure": "arrival", "about": "arriv"}, "", "no number there"),
        (FREE, {"measure": "arrival", "about": "arriv", "tol": 2}, "Both arrive after 7.3 s.", ""),
        (FREE, {"measure": "arrival", "about": "arriv"}, "They arrive in 5.9 s. The second arrives in 9.1 s.", "9.1 s"),
        (FREE, {"measure": "arrival", "about": "arriv"}, "It arrives before 60 s. It arrives in 5.9 s.", "60 s"),
        (FREE, {"measure": "arrival", "about": "arriv", "besides": [60]}, "It arrives before 60 s: in 5.9 s.", ""),
        (FREE, {"measure": "arrival", "about": "arriv"}, "Arrival: row 2 of 3\n| robots | 5.9 |", ""),
        (FREE, {"measure": "arrived", "about": "arriv"}, "2 of 2 robots arrive.", ""),
        (FREE, {"measure": "arrived", "about": "arriv", "seeds": [0, 1]}, "4 robots arrived in two runs.", ""),
        (FREE, {"measure": "arrived", "about": "arriv"}, "1 robot arrives.", "1 robot"),
        (FREE, {"measure": "path", "about": "path"}, "The path is 5.9 m long.", ""),
        (FREE, {"measure": "path", "about": "path"}, "The path is 7 m long.", "7 m"),
        (FREE, {"measure": "separation", "to": "box", "about": "distance"}, "A distance of 130 cm is kept.", ""),
        (FREE, {"measure": "separation", "to": "box", "about": "distance"}, "Distance: 1 m", "1 m"),
        (FREE, {"measure": "separation", "to": "missing", "about": "distance"}, "Distance: 1 m", "missing: no body"),
        (BLOCKED, {"measure": "collided", "about": "hit"}, "1 of them hits the box.", ""),
        (BLOCKED, {"measure": "arrival", "about": "arriv"}, "One arrives after 5.9 s, the other does not.", ""),
        (BLOCKED, {"measure": "arrived", "about": "arriv"}, "All 2 arrive.", "All 2"),
        (BLOCKED, {"of": "missing", "measure": "arrived", "about": "arriv"}, "0 arrive.", "missing: no body"),
    ],
)  # fmt: skip
def test_a_reply_reports_what_happens_in_an_episode(text: str, keys: dict[str, Any], reply: str, problem: str) -> None:
    material = world(text, reply, box={"named": "box"}, missing={"named": "missing"})
    observation = seen(material, "states", {"of": "robots", "seconds": 12, **keys})
    assert observation.passed == (problem == ""), observation
    assert problem in observation.observed


@pytest.mark.parametrize(
    "keys",
    [
        {"property": "radius", "measure": "path", "about": "x"},
        {"about": "x"},
        {"measure": "separation", "about": "x"},
        {"measure": "path", "about": "x", "to": "all"},
    ],
)
def test_a_statement_that_cannot_be_looked_for_is_refused(keys: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="give either"):
        seen(world(FREE), "states", {"of": "robots", "seconds": 12, **keys})
