"""The information that policies and behaviors declare: changes of everything else leave decisions the same.

Each pair of worlds differs in one kind of facts about the rest of the world, and in nothing else. A policy drives the
same robot in each. Where it does not declare these facts, its decisions are equal; where it does, some pair tells.
"""

from __future__ import annotations

import itertools
from ast import literal_eval
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import pytest
import yaml

import irsim
from irsim.benchmarks.report.markdown import markdown
from irsim.env import Env
from irsim.options.knowledge import Fact, knowledge_class
from irsim.options.registry import BEHAVIORS
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import open_policy
from irsim.policies.trained import trained_policies
from irsim.scenario.open import read_scenario
from irsim.scenario.yaml.document import load_text

LAWS = ("dash", "orca", "rvo", "sfm", "avocado", "footprint_orca")
Shape = Mapping[str, Any]
CIRCLE: Shape = MappingProxyType({"name": "circle", "radius": 0.4})
FLAT: Shape = MappingProxyType({"name": "polygon", "vertices": [[0.5, 0], [0, 0.2], [-0.5, 0], [0, -0.2]]})
WIDE: Shape = MappingProxyType({"name": "polygon", "vertices": [[0.5, 0], [0, 0.45], [-0.5, 0], [0, -0.45]]})
# the circle round both polygons is the same
FAR = (26.0, 10.0)
NEVER = 1e-300
"""A speed that moves nothing [m/s]."""


class Scene(NamedTuple):
    """A robot whose decision counts, another mover, and a thing that stands.

    Attributes:
        place, heading, shape, goal, law, top_speed: Of the other mover, which stands still at first.
        thing, thing_shape: Of the thing.
    """

    place: tuple[float, float] = (3.4, 5.1)
    heading: float = 3.0
    shape: Shape = CIRCLE
    goal: tuple[float, float] | None = (0.5, 5.2)
    law: str = "dash"
    top_speed: float = 1.0
    thing: tuple[float, float] = FAR
    thing_shape: Shape = CIRCLE
    steps: int = 1


PAIRS: dict[Fact, list[tuple[Scene, Scene]]] = {
    "circles": [
        (Scene(), Scene(place=(3.5, 5.0))),
        (Scene(place=(2.8, 5.0)), Scene(place=(2.8, 6.0))),
        (Scene(), Scene(shape={"name": "circle", "radius": 0.6})),
    ],
    "outlines": [
        (
            Scene(shape=FLAT, heading=heading, place=place, steps=5),
            Scene(shape=WIDE, heading=heading, place=place, steps=5),
        )
        for heading in (0.0, 1.5)
        for place in ((3.4, 5.1), (2.8, 5.1))
    ],
    "headings": [(Scene(), Scene(heading=1.0)), (Scene(place=(2.9, 5.3)), Scene(place=(2.9, 5.3), heading=-1.0))],
    "arrivals": [
        (Scene(place=place, goal=place, top_speed=NEVER, steps=15), Scene(place=place, top_speed=NEVER, steps=15))
        for place in ((3.4, 5.0), (3.0, 5.0))
    ],
    "laws": [
        (Scene(law=one, place=place), Scene(law=other, place=place))
        for one, other in itertools.combinations(LAWS, 2)
        for place in ((3.4, 5.1), (3.0, 5.0))
    ],
    "static": [
        (Scene(thing=(2.9, 4.8), place=FAR), Scene(thing=(3.0, 4.7), place=FAR)),
        (Scene(thing=(2.9, 5.0), place=FAR, thing_shape=FLAT), Scene(thing=(2.9, 5.0), place=FAR, thing_shape=WIDE)),
    ],
}
OUTSIDE = [
    (Scene(), Scene(goal=(4.0, 11.0))),  # where the other one wants to go
    (Scene(), Scene(top_speed=0.8)),  # and how fast it could
]
"""Facts that no behavior and no policy knows."""


def decision(policy: str, scene: Scene) -> bytes:
    """State and velocity of the robot after some decisions."""
    plain = scene._replace(shape=dict(scene.shape), thing_shape=dict(scene.thing_shape))
    return _decision(policy, repr(tuple(plain)))


@cache
def _decision(policy: str, text: str) -> bytes:
    scene = Scene(*literal_eval(text))
    opened = open_policy(policy)
    drive = "omni" if opened.drives is not None and "diff" not in opened.drives else "diff"
    common = {"kinematics": {"name": drive}, "sensors": [{"name": "lidar2d", "number": beams(policy), "range_max": 6}]}
    limits = {"vel_max": [1, 1], "vel_min": [-1, -1]}
    me = {**common, **limits, "shape": {"name": "circle", "radius": 0.3}, "state": [2, 5, 0], "goal": [9, 5, 0]}
    other = {**common, "shape": scene.shape, "state": [*scene.place, scene.heading], "behavior": {"name": scene.law}}
    other |= {"vel_max": [scene.top_speed] * 2, "vel_min": [-scene.top_speed] * 2}
    if scene.goal is not None:
        other["goal"] = [*scene.goal, 0]
    thing = {"shape": scene.thing_shape, "state": [*scene.thing, 0]}
    if isinstance(opened, BehaviorPolicy):
        me["behavior"], opened = yaml.safe_load(policy) if policy[0] == "{" else {"name": policy}, None
    world = {"width": 30, "height": 12, "step_time": 0.1, "collision_mode": "unobstructed"}
    text = yaml.safe_dump({"world": world, "robot": [me, other], "obstacle": [thing]})
    scenario, _ = read_scenario(load_text(text), strict=False)
    env = Env(scenario, seed=1, display=False, headless=True, log_level="ERROR", policy=opened)
    for _ in range(scene.steps if opened is None else min(scene.steps, 2)):  # a policy drives the other one, too
        env.step()
    robot = env.robot_list[0]
    decided = np.concatenate([np.ravel(robot.state), np.ravel(robot.velocity)])
    env.end(ending_time=0.0)
    return decided.tobytes()


def beams(policy: str) -> int:
    needs = open_policy(policy).needs
    return needs.beams or 90


POLICIES = [
    *(name for name in sorted(BEHAVIORS.names()) if name != "replay"),
    "{name: follow, local: orca}",
    *sorted(trained_policies()),
]


@pytest.mark.parametrize("policy", POLICIES)
def test_a_decision_depends_on_what_the_policy_declares_and_on_nothing_else(policy: str) -> None:
    known = open_policy(policy).known()
    assert known is not None
    seen = {"circles", "outlines", "static"} if "scan" in known else set()
    told = {fact for fact, pairs in PAIRS.items() if any(decision(policy, a) != decision(policy, b) for a, b in pairs)}
    assert told - seen == known & set(PAIRS) - seen, knowledge_class(known)
    for a, b in OUTSIDE:
        assert decision(policy, a) == decision(policy, b)


def test_classes_are_short_names_of_what_is_known() -> None:
    names = {name: open_policy(name).knowledge() for name in ("dash", "orca", "footprint_orca", *trained_policies())}
    assert names["dash"] == "blind"
    assert names["orca"] == "circles+intent"
    assert names["footprint_orca"] == "outlines+intent"
    assert names["multi_robot"] == "neighbors(8, 4 m)+outlines+intent"
    assert names["sarl"] == "neighbors(5)"
    assert names["corridor_social"] == "lidar+neighbors(8, 5 m)"
    assert open_policy("{name: follow, local: orca}").knowledge() == "map+outlines+intent"
    assert open_policy("as-written").knowledge() is None


def test_a_benchmark_says_what_each_policy_knows() -> None:
    world = "world: {time_limit: 1}\nrobot: {kinematics: {name: diff}, state: [1, 1], goal: [9, 9]}\n"
    result = irsim.benchmark(world, ["dash", "as-written"], 1)
    assert result.information == {"dash": "blind"}
    told = markdown(result)
    assert "- blind:\n  - dash: `dash`" in told
    assert "- as-written: `as-written`" in told
