"""Small scenarios for tests of policies."""

from __future__ import annotations

from typing import Any

from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.simulation import Simulation

ROBOT: dict[str, Any] = {
    "kinematics": {"name": "omni"},
    "shape": {"name": "circle", "radius": 0.2},
    "state": [1, 1, 0],
    "goal": [9, 1, 0],
    "behavior": {"name": "dash"},
}

FREE = """
world: {width: 10, height: 10, step_time: 0.1, time_limit: 15}
robot:
  - {number: 2, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [[1, 2, 0], [1, 8, 0]],
     goal: [[4, 2], [4, 8]]}
obstacle:
  - {shape: {name: circle, radius: 0.5}, state: [8, 5, 0]}
"""
"""Two robots with nothing in their way."""


def scenario(*robots: dict[str, Any], obstacles: Any = (), **world: Any) -> ResolvedScenario:
    """A scenario of robots that differ from ``ROBOT`` in some keys."""
    data = {"world": {"width": 10, "height": 10, **world}, "robot": [{**ROBOT, **robot} for robot in robots]}
    if obstacles:
        data["obstacle"] = list(obstacles)
    return or_raise(read(data, strict=True, name="test"))[0]


def simulation(*robots: dict[str, Any], seeds: Any = (0,), **keys: Any) -> Simulation:
    """Its worlds, one for each seed."""
    return Simulation(scenario(*robots, **keys), list(seeds))
