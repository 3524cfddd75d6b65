"""The rooms in which bodies stand: of walls as lines, rectangles and maps, with doors and furniture."""

from __future__ import annotations

import io
from typing import Any

import pytest

from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.material import Material
from tests.evals.conftest import failed, made_up, seen, world

ROOM = {"of": "robots", "doors": 1.2, "long_side": 5, "short_side": 4, "area": {"eq": 19.75, "tol": 0.3}}
"""The lower left one of four rooms, whose doors are 90 cm wide."""
LINES = ["[[5, 0], [5, 1.5]]", "[[5, 2.4], [5, 6]]", "[[5, 6.9], [5, 8]]", "[[0, 4], [2, 4]]", "[[2.9, 4], [10, 4]]"]
AS_LINES = [f"{{shape: {{name: linestring, vertices: {ends}}}, state: [0, 0, 0]}}" for ends in LINES]
AS_RECTANGLES = [
    f"{{shape: {{name: rectangle, length: {length}, width: {width}}}, state: [{x}, {y}, 0]}}"
    for length, width, x, y in [
        (0.1, 1.5, 5, 0.75),
        (0.1, 3.6, 5, 4.2),
        (0.1, 1.1, 5, 7.45),
        (2, 0.1, 1, 4),
        (7.1, 0.1, 6.45, 4),
    ]
]
TABLE = "{shape: {name: circle, radius: 0.4}, state: [1.2, 1, 0]}"
ROBOT = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}"


def flat(
    walls: list[str], place: str = "[2, 2, 0]", goal: str = "goal: [7, 6, 0]", size: str = "width: 10, height: 8"
) -> Material:
    robot = f"{{{ROBOT}, state: {place}, {goal}}}"
    text = f"world: {{{size}}}\nrobot: [{robot}]\nobstacle: [{', '.join(walls)}]\n"
    return world(text, missing={"named": "missing"})


@pytest.mark.parametrize("walls", [AS_LINES, AS_RECTANGLES])
@pytest.mark.parametrize(
    ("place", "keys", "passes"),
    [
        ("[2, 2, 0]", {}, True),
        ("[0.3, 0.3, 0]", {}, True),  # in a corner, to which a disc of 1.2 m does not get
        ("[7, 6, 0]", {}, True),
        ("[4.9, 2, 0]", {}, False),  # in a door
        ("[2, 2, 0]", {"doors": 0.8}, False),  # the doors are open: there is but one room
        ("[2, 2, 0]", {"doors": 0.8, "long_side": 10, "short_side": 8, "area": {"about": 79}}, True),
        ("[2, 2, 0]", {"long_side": 4.5}, False),
        ("[2, 2, 0]", {"short_side": 3.5}, False),
        ("[2, 2, 0]", {"area": {"ge": 21}}, False),
        ("[2, 2, 0]", {"of": "missing"}, False),
    ],
)
def test_a_room_ends_at_its_walls_and_doors(walls: list[str], place: str, keys: dict[str, Any], passes: bool) -> None:
    assert seen(flat(walls, place), "room", {**ROOM, **keys}).passed == passes


@pytest.mark.parametrize(
    ("keys", "passes"),
    [
        ({"area": {"eq": 19.5, "tol": 0.02}}, True),  # the table takes 0.5 m²
        ({"area": 20}, False),
    ],
)
def test_a_room_is_furnished(keys: dict[str, Any], passes: bool) -> None:
    table = TABLE.replace("1.2, 1", "2.6, 2")
    assert seen(flat([*AS_LINES, table], "[1, 1, 0]"), "room", {**ROOM, **keys}).passed == passes


def test_a_cupboard_that_leaves_no_way_beside_it_bounds_a_room() -> None:
    cupboard = "{shape: {name: rectangle, length: 1, width: 3}, state: [0.5, 1.5, 0]}"
    furnished = flat([*AS_LINES, cupboard], "[3, 2, 0]")
    assert seen(furnished, "room", {**ROOM, "long_side": 4, "short_side": 4, "area": {"eq": 16, "tol": 0.1}}).passed
    assert not seen(furnished, "room", ROOM).passed


def test_the_room_of_a_goal() -> None:
    other = {"what": "goal", "long_side": 5, "short_side": 4}
    assert seen(flat(AS_LINES, goal="goal: [7, 6, 0]"), "room", {**ROOM, **other}).passed
    assert not seen(flat(AS_LINES[:2], goal="goal: [7, 2, 0]"), "room", {**ROOM, **other}).passed
    assert "has no goal" in seen(flat(AS_LINES, goal="name: idle"), "room", {**ROOM, **other}).observed


def test_an_open_world_ends_at_its_edge() -> None:
    hall = {"of": "robots", "doors": 1, "long_side": 12, "short_side": 9, "area": 108}
    size = "width: 12, height: 9, offset: [-3, -3]"
    assert seen(flat([], size=size), "room", hall).passed
    assert seen(flat([], size=f"{size}, boundary: walls"), "room", hall).passed


@pytest.mark.parametrize(("wall", "wrong"), [(60, []), (40, ["room"])])
def test_the_walls_of_a_map_bound_a_room(wall: int, wrong: list[str]) -> None:
    from PIL import Image

    picture = Image.new("L", (100, 80), 255)
    for box in (
        (48, 0, 52, wall),
        (48, 69, 52, 80),
        (0, 38, 48, 42),
    ):  # with a door of 90 cm at the foot of the first one
        picture.paste(0, box)
    buffer = io.BytesIO()
    picture.save(buffer, "PNG")
    robot = f"robot: [{{{ROBOT}, state: [2, 2, 0], goal: [3, 3, 0]}}]\n"
    case = made_up({"id": "room", "room": {"of": "robots", "doors": 1.2, "long_side": 4.8, "short_side": 3.8}})
    answer = Answer(
        "x",
        {"scenario.yaml": "world: {width: 10, height: 8, obstacle_map: map.png}\n" + robot},
        blobs={"map.png": buffer.getvalue()},
    )
    assert failed(grade(case, answer)) == wrong
