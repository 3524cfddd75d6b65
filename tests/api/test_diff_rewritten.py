"""Comparisons of scenarios that mean the same, and of such that do not."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim
from irsim.env import Env
from irsim.scenario.model.entry import Entry
from irsim.scenario.model.world import WorldModel
from irsim.scenario.read import read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import load_data
from tests.effort import examples

pytestmark = pytest.mark.one_python

DRIVES = ("diff", "omni", "acker")
SHAPES = ({"name": "circle", "radius": 0.2}, {"name": "rectangle", "length": 0.5, "width": 0.3})


@st.composite
def scenarios(draw: st.DrawFn) -> dict[str, Any]:
    """Robots and obstacles on a grid, several of them in one entry; some groups are led."""
    places = [[x, y] for x in range(2, 20, 2) for y in range(2, 20, 2)]
    order = draw(st.permutations(range(len(places))))
    free = iter([places[i] for i in order])
    named = iter(range(100))

    def entry(role: str) -> dict[str, Any]:
        number = draw(st.integers(1, 3))
        keys: dict[str, Any] = {"number": number, "shape": draw(st.sampled_from(SHAPES))}
        keys["state"] = [[*next(free), draw(st.sampled_from([0, 0.5, -1]))] for _ in range(number)]
        if draw(st.booleans()):
            keys["name"] = [f"{role} {next(named)}" for _ in range(number)]
        if role == "robot":
            drive = draw(st.sampled_from(DRIVES))
            keys["kinematics"] = {"name": drive, "wheelbase": 0.3} if drive == "acker" else {"name": drive}
            keys["goal"] = [[x + 0.5, y + 0.5] for x, y, _ in keys["state"]]
            keys["group"] = draw(st.integers(0, 2))
            keys["behavior"] = {"name": draw(st.sampled_from(["dash", "orca"]))}
            keys["vel_max"] = draw(st.sampled_from([[1, 0.5], [2, 1]]))
            if draw(st.booleans()):
                keys["group_behavior"] = {"name": "orca", "safe_radius": draw(st.sampled_from([0.1, 0.2]))}
            if draw(st.booleans()):
                keys["sensors"] = [{"name": "lidar2d", "range_max": draw(st.sampled_from([3, 4]))}]
        return keys

    return {
        "world": {"width": 20, "height": 20},
        "robot": [entry("robot") for _ in range(draw(st.integers(1, 3)))],
        "obstacle": [entry("obstacle") for _ in range(draw(st.integers(1, 2)))],
    }


def split(data: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """Some entries as one per object."""
    done: dict[str, Any] = dict(data)
    for role in ("robot", "obstacle"):
        entries = []
        for entry in data[role]:
            if rng.random() < 0.5:
                entries.append(entry)
                continue
            alike = {key: value for key, value in entry.items() if key not in ("number", "state", "goal", "name")}
            for i in range(entry["number"]):
                entries.append(alike | {key: entry[key][i] for key in ("state", "goal", "name") if key in entry})
        done[role] = entries
    return done


def with_defaults(data: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """Some defaults written out."""
    usual = {"goal_threshold": 0.1, "static": False, "unobstructed": False, "arrive_mode": "position", "color": None}
    done: dict[str, Any] = {"world": {"step_time": 0.1, "collision_mode": "stop", "boundary": "none"} | data["world"]}
    for role in ("robot", "obstacle"):
        done[role] = [entry | {k: v for k, v in usual.items() if rng.random() < 0.5} for entry in data[role]]
    return done


def shuffled(value: Any, rng: random.Random) -> Any:
    """Keys in another order, whole numbers as decimal ones."""
    if isinstance(value, dict):
        keys = list(value)
        rng.shuffle(keys)
        return {key: value[key] if key in ("number", "group") else shuffled(value[key], rng) for key in keys}
    if isinstance(value, list):
        return [shuffled(item, rng) for item in value]
    return float(value) if type(value) is int and rng.random() < 0.5 else value


def written(data: dict[str, Any], rng: random.Random) -> str:
    """As flow or block, what is equal behind anchors or not."""
    known: dict[str, Any] = {}

    def shared(value: Any) -> Any:
        if isinstance(value, dict):
            value = {key: shared(item) for key, item in value.items()}
        return known.setdefault(repr(value), value) if isinstance(value, (dict, list)) else value

    class Plain(yaml.SafeDumper):
        def ignore_aliases(self, data: Any) -> bool:
            return True

    dumper = rng.choice([yaml.SafeDumper, Plain])
    text: str = yaml.dump(
        shared(data), Dumper=dumper, default_flow_style=rng.choice([True, False, None]), sort_keys=False
    )
    return text


@settings(max_examples=examples(30), deadline=None)
@given(data=scenarios(), seed=st.integers(0, 2**32 - 1))
def test_other_ways_to_write_a_world_are_the_same_world(data: dict[str, Any], seed: int) -> None:
    rng = random.Random(seed)
    other = data
    for change in (split, with_defaults, shuffled):
        if rng.random() < 0.7:
            other = change(other, rng)
    before, after = written(data, rng), written(other, rng)
    for difference in (
        irsim.diff(before_text=before, after_text=after),
        irsim.diff(before_text=after, after_text=before),
    ):
        assert difference.world == [], (before, after, difference.summary)
        assert "the worlds are the same" in difference.summary
    assert irsim.diff(before_text=before, after_text=written(shuffled(data, rng), rng)).same


EDITS: dict[str, Any] = {
    "group": st.integers(0, 2),
    "group_behavior": st.sampled_from([None, {"name": "orca"}, {"name": "orca", "safe_radius": 0.4}]),
    "behavior": st.sampled_from([None, {"name": "dash"}, {"name": "rvo"}]),
    "vel_max": st.sampled_from([[0.5, 0.5], [2, 2]]),
    "kinematics": st.sampled_from([{"name": "diff"}, {"name": "omni"}]),
    "static": st.booleans(),
}


@settings(max_examples=examples(40), deadline=None)
@given(data=scenarios(), edit=st.data())
def test_objects_that_move_otherwise_are_told(data: dict[str, Any], edit: st.DataObject) -> None:
    number = edit.draw(st.integers(0, len(data["robot"]) - 1))
    key = edit.draw(st.sampled_from(sorted(EDITS)))
    robots = [*data["robot"]]
    robots[number] = robots[number] | {key: edit.draw(EDITS[key])}
    other = data | {"robot": robots}
    difference = irsim.diff(before_text=yaml.safe_dump(data), after_text=yaml.safe_dump(other))
    if not np.array_equal(_ways(data), _ways(other)):
        assert difference.world, (data, other)
    if not difference.world:
        assert "the worlds are the same" in difference.summary


def _ways(data: dict[str, Any]) -> Any:
    """Poses of the robots in some steps."""
    scenario = _resolved(data)
    assert scenario is not None
    env = Env(scenario, display=False, headless=True, seed=0, log_level="ERROR")
    ways = []
    for _ in range(15):
        env.step()
        ways.append([robot.state[:3, 0].tolist() for robot in env.robot_list])
    env.end(ending_time=0.0)
    return np.array(ways)


SEES: dict[str, Any] = {"sensors": [{"name": "detector"}]}
"""The sensor that `perceives: tracks` needs."""
LED: dict[str, Any] = {
    "world": {"width": 20, "height": 20, "collision_mode": "contact", "fog_map": True},
    "robot": [
        {
            "kinematics": {"name": "diff"},
            "state": [2, 2, 0],
            "goal": [9, 2],
            "group": 0,
            "behavior": {"name": "dash"},
            **SEES,
        },
        {
            "kinematics": {"name": "acker", "wheelbase": 1},
            "state": [2, 6, 0],
            "goal": [9, 6],
            "group": 1,
            "group_behavior": {"name": "orca"},
            **SEES,
        },
        {"kinematics": {"name": "omni"}, "state": [2, 9, 0], "goal": [9, 9], "group": 1, **SEES},
    ],
    "obstacle": [{"state": [15, 15, 0], "shape": {"name": "circle", "radius": 0.5}, **SEES}],
}
OTHER: dict[str, Any] = {
    "number": 2,
    "distribution": {"name": "circle", "radius": 4},
    "name": "walker",
    "tags": ["pedestrian"],
    "state": [3, 12, 0.2],
    "goal": [12, 3],
    "waypoints": [[4, 4], [5, 5]],
    "velocity": [0.1, 0.1],
    "start_time": 3.0,
    "appear_time": 4.0,
    "kinematics": {"name": "omni_angular"},
    "shape": {"name": "rectangle", "length": 1, "width": 0.4},
    "behavior": {"name": "dash", "wander": True},
    "group_behavior": {"name": "orca", "safe_radius": 0.5},
    "sensors": [{"name": "lidar2d"}],
    "color": "red",
    "description": "car_blue.png",
    "static": True,
    "vel_min": [-0.5, -0.5],
    "vel_max": [0.5, 0.5],
    "acce": [0.5, 0.5],
    "actuation": {"lag": 0.2},
    "reflectivity": 0.1,
    "material": "glass",
    "perceives": "tracks",
    "angle_range": [0, 6.283185307],
    "goal_threshold": 0.3,
    "arrive_mode": "state",
    "group": 0,
    "group_name": "walkers",
    "unobstructed": True,
    "fov": 1,
    "fov_radius": 2,
    "fov_occlusion": True,
    "mass": 3,
    "friction": 0.2,
    "inertia": 2,
    "restitution": 0.4,
    "vel_dim": 3,
    "state_dim": 4,
}
NO_EFFECT = {
    ("robot", 2): {"group_behavior"},
    ("obstacle", 0): {
        "goal", "waypoints", "group_behavior", "group", "vel_min", "vel_max", "acce", "angle_range", "vel_dim",
        "start_time", "actuation",
    },
}  # fmt: skip
"""Only the first of a group leads it; what never moves follows no object, and has no goals or limits."""
NOT_OF_THE_WORLD = {"role", "plot"}
"""The section says the role already; how a thing is drawn is not in the world."""
WORLD: dict[str, Any] = {
    "height": 21,
    "width": 22,
    "offset": [-1, -1],
    "step_time": 0.05,
    "sample_time": 0.2,
    "time_limit": 7,
    "seed": 3,
    "step_mode": "external",
    "control_mode": "keyboard",
    "collision_mode": "stop",
    "contacts": "swept",
    "integration": "exact",
    "after_arrival": "freeze",
    "boundary": "walls",
    "mdownsample": 2,
    "obstacle_map": {"name": "perlin", "resolution": 0.5},
    "fog_map": False,
    "fog_map_resolution": 0.5,
    "zones": [{"name": "door", "line": [[1, 1], [2, 2]]}],
    "gravity": 5,
    "friction": 0.1,
    "restitution": 0.2,
    "drive_tau": 0.3,
}
NOT_OF_WORLDS = {"status", "name", "description", "metadata", "depth", "plot"}


def test_the_tables_below_have_every_key() -> None:
    assert set(Entry.model_fields) == set(OTHER) | NOT_OF_THE_WORLD
    assert set(WorldModel.model_fields) == set(WORLD) | NOT_OF_WORLDS


@pytest.mark.parametrize("key", OTHER)
@pytest.mark.parametrize("place", [("robot", 0), ("robot", 1), ("robot", 2), ("obstacle", 0)], ids=str)
def test_what_changes_an_object_is_told(key: str, place: tuple[str, int]) -> None:
    role, number = place
    entry = {name: value for name, value in LED[role][number].items() if (key, name) != ("waypoints", "goal")}
    entries = [*LED[role]]
    entries[number] = entry | {key: OTHER[key]}
    _compare(LED, LED | {role: entries}, same=key in NO_EFFECT.get(place, ()))


@pytest.mark.parametrize("key", WORLD)
def test_what_changes_the_world_is_told(key: str) -> None:
    _compare(LED, LED | {"world": LED["world"] | {key: WORLD[key]}}, always=True)


def _compare(before: dict[str, Any], after: dict[str, Any], *, always: bool = False, same: bool = False) -> None:
    resolved = _resolved(before), _resolved(after)
    difference = irsim.diff(before_text=yaml.safe_dump(before), after_text=yaml.safe_dump(after))
    assert difference.world is not None
    if same:
        assert "the worlds are the same" in difference.summary
    elif always or _objects(resolved[0]) != _objects(resolved[1]):
        assert difference.world, difference.summary
        assert "the worlds are the same" not in difference.summary


def _resolved(data: dict[str, Any]) -> ResolvedScenario | None:
    return read(load_data(data)).scenario


def _objects(scenario: ResolvedScenario | None) -> list[dict[str, Any]]:
    assert scenario is not None
    return [
        {key: getattr(record, key) for key in record.__slots__ if key not in ("path", "index", "plot")}
        for record in scenario.objects
    ]
