"""The example of each code gives that code, and what is to be written instead does not."""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from irsim.diagnostics.codes import CODES
from irsim.diagnostics.examples import EXAMPLES
from irsim.scenario.read import read
from irsim.validation.feasibility.check import feasibility_findings

ROBOT = {
    "kinematics": {"name": "diff"},
    "shape": {"name": "circle", "radius": 0.2},
    "behavior": {"name": "dash"},
    "state": [1, 1, 0],
    "goal": [9, 9],
}
OBSTACLE = {"shape": {"name": "circle", "radius": 0.3}, "state": [5, 8, 0]}
AS_TEXT = ("yaml-", "empty-", "multiple-", "not-a-scenario", "unsupported-", "duplicate-key")


def codes(code: str, text: str) -> set[str]:
    if code.startswith(AS_TEXT):
        return {d.code for d in read(text + "\n", strict=True, feasibility=feasibility_findings).diagnostics}
    data: dict[str, Any] = yaml.safe_load(text)
    robot = data.get("robot", {})
    if robot is not None:
        whole = {**ROBOT, **robot}
        if "distribution" in robot or "waypoints" in robot:
            whole = {key: value for key, value in whole.items() if key in robot or key not in ("state", "goal")}
        data["robot"] = [whole]
    else:
        data["robot"] = []
    if "obstacle" in data:
        kept = {} if code in ("default-state", "missing-key") else OBSTACLE
        data["obstacle"] = [{**kept, **data["obstacle"]}]
    return {d.code for d in read(data, strict=True, feasibility=feasibility_findings).diagnostics}


@pytest.mark.parametrize("code", EXAMPLES)
def test_the_example_shows_it(code: str) -> None:
    wrong, right = EXAMPLES[code]
    assert code in CODES
    assert code in codes(code, wrong)
    assert code not in codes(code, right)


def test_what_can_be_shown_is_shown() -> None:
    files = ("file", "image", "unreadable", "not-text", "not-a-file", "path", "map", "no-map", "not-yet")
    sizes = ("too-", "recursive", "alias", "bad-key", "invalid-value")
    code_of_users = ("behavior-for-other-drive", "group-", "fog-")
    of_tasks = ("unknown-reward", "unknown-part", "bridges-not-opened")
    others = (*files, *sizes, *code_of_users, *of_tasks)
    left = [code for code in CODES if code not in EXAMPLES and not code.startswith(others)]
    assert left == [], "give each of these codes an example in irsim/diagnostics/examples.py"
