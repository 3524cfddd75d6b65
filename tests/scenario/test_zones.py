"""`world.zones`: what is accepted, what is refused, and with which repair."""

from __future__ import annotations

from typing import Any

import jsonschema
import pytest

import irsim
from irsim.scenario.model.json_schema import json_schema
from irsim.scenario.read import read

DOOR = {"name": "door", "line": [[5, 4], [5, 6]]}
SQUARE = [[1, 1], [3, 1], [3, 3], [1, 3]]
GOOD: list[Any] = [
    None,
    [],
    [DOOR],
    [DOOR, {"name": "kitchen", "rectangle": [1, 1, 4, 3], "color": "red"}],
    [{"name": "stairs", "polygon": SQUARE}, {"name": "clockwise", "polygon": SQUARE[::-1]}],
    [{"name": "dock", "circle": {"center": [2, 2], "radius": 0.5}, "line": None}],
]
Path = tuple[str | int, ...]
BAD: list[tuple[list[Any], str, Path]] = [
    ([DOOR, {**DOOR}], "duplicate-name", (1, "name")),
    ([{"name": "nowhere"}], "missing-key", (0,)),
    ([{"line": [[1, 1], [2, 2]]}], "missing-key", (0, "name")),
    ([{**DOOR, "circle": {"center": [2, 2], "radius": 1}}], "conflicting-keys", (0, "circle")),
    ([{"name": "point", "line": [[1, 1], [1, 1]]}], "too-few-vertices", (0, "line")),
    ([{"name": "bent", "line": [[1, 1], [2, 2], [3, 1]]}], "wrong-length", (0, "line")),
    ([{"name": "flat", "line": [1, 1, 2, 2]}], "wrong-type", (0, "line")),
    ([{"name": "bow", "polygon": [[1, 1], [3, 3], [3, 1], [1, 3]]}], "invalid-polygon", (0, "polygon")),
    ([{"name": "thin", "polygon": [[1, 1], [2, 2], [3, 3]]}], "invalid-polygon", (0, "polygon")),
    ([{"name": "two", "polygon": [[1, 1], [2, 2], [1, 1]]}], "too-few-vertices", (0, "polygon")),
    ([{"name": "back", "rectangle": [4, 1, 1, 3]}], "range-order", (0, "rectangle")),
    ([{"name": "empty", "rectangle": [4, 1, 4, 3]}], "range-order", (0, "rectangle")),
    ([{"name": "dot", "circle": {"center": [2, 2], "radius": 0}}], "out-of-range", (0, "circle", "radius")),
    ([{"name": "far", "rectangle": [0, 0, 1, 1e9]}], "too-large", (0,)),
    ([{**DOOR, "locked": True}], "unknown-key", (0, "locked")),
]  # fmt: skip


@pytest.mark.parametrize("zones", GOOD, ids=str)
def test_accepted_by_the_reader_and_by_the_schema(zones: Any) -> None:
    data = {"world": {"zones": zones}}
    assert read(data, strict=True).diagnostics == []
    jsonschema.Draft202012Validator(json_schema()).validate(data)


@pytest.mark.parametrize(("zones", "code", "path"), BAD, ids=[code for _, code, _ in BAD])
def test_refused_with_a_code_and_its_place(zones: list[Any], code: str, path: Path) -> None:
    for strict in (False, True):
        reading = read({"world": {"zones": zones}}, strict=strict)
        assert [(d.severity, d.code, d.path[2:]) for d in reading.diagnostics] == [("error", code, path)]
        assert reading.scenario is None


@pytest.mark.parametrize("zones", [z for z, code, _ in BAD if code in ("missing-key", "conflicting-keys")], ids=str)
def test_the_schema_asks_for_exactly_one_outline(zones: list[Any]) -> None:
    assert not jsonschema.Draft202012Validator(json_schema()).is_valid({"world": {"zones": zones}})


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("line: [1, 1, 2, 2]", "line: [[1, 1], [2, 2]]"),
        ("rectangle: [4, 1, 1, 3]", "rectangle: [1, 1, 4, 3]"),
        ("polygon: [[1, 1], [3, 1], [3, 3], [3, 1]]", None),
    ],
)
def test_repairs(before: str, after: str | None) -> None:
    text = f"world: {{zones: [{{name: a, {before}}}]}}\n"
    mended, _ = irsim.fix(text=text)
    assert mended == (text if after is None else text.replace(before, after))


def test_a_zone_outside_the_world_is_a_warning() -> None:
    reading = read({"world": {"width": 5, "zones": [DOOR, {"name": "out", "line": [[6, 1], [7, 1]]}]}})
    assert [(d.severity, d.code, d.path) for d in reading.diagnostics] == [
        ("warning", "zone-outside-world", ("world", "zones", 1))
    ]
    assert reading.scenario is not None


@pytest.mark.parametrize(
    ("ground", "drive", "told"),
    [
        ("slip: 0.2", "{name: diff}", None),
        ("grip: 0.2", "{name: diff}", "only 'diff_dynamic' and 'single_track' do"),
        ("grip: 0.2", "{name: single_track}", None),
        ("surface: gravel", "{name: omni}", "only 'skid_steer' do"),
        ("surface: gravel", "{name: skid_steer}", None),
    ],
)
def test_ground_that_no_drive_feels_is_told(ground: str, drive: str, told: str | None) -> None:
    text = f"world: {{zones: [{{name: wet, rectangle: [1, 1, 2, 2], {ground}}}]}}\nrobot: {{kinematics: {drive}}}\n"
    unfelt = [one for one in read(text).diagnostics if one.code == "ground-unfelt"]
    assert unfelt[0].message.endswith(told) if told else not unfelt, unfelt


def test_a_line_has_no_ground() -> None:
    reading = read({"world": {"zones": [{**DOOR, "slip": 0.2}]}})
    assert [(d.severity, d.code, d.path[2:]) for d in reading.diagnostics] == [
        ("error", "conflicting-keys", (0, "slip"))
    ]


def test_zones_do_not_change_what_objects_do() -> None:
    drive = {"kinematics": {"name": "diff", "noise": True}, "behavior": {"name": "orca"}, "sensors": [{"number": 9}]}
    robots = {"number": 5, "distribution": {"name": "random"}, **drive}
    zones = [{"name": "all", "rectangle": [0, 0, 10, 10]}, {"name": "l", "line": [[5, 0], [5, 10]]}]
    worlds = [read({"world": {"width": 10, **more}, "robot": robots}).scenario for more in ({}, {"zones": zones})]
    plain, watched = (irsim.make(world, seed=3, headless=True) for world in worlds)
    for env in (plain, watched):
        env.advance(150)
    assert plain.simulation.pose.tobytes() == watched.simulation.pose.tobytes()
    assert plain.simulation.ranges.tobytes() == watched.simulation.ranges.tobytes()
    assert [e for e in watched.events if e.zone is None] == plain.events
    assert len(watched.events) > len(plain.events)
