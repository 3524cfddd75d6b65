"""`avocado`: its opinion dynamics against plain NumPy, its shares, its noise, and that it is ORCA."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
import irsim._core as core
from irsim.scenario.read import or_raise, read
from irsim.simulation.simulation import Simulation
from irsim.testing import scenario_with, simulate
from irsim.testing.conformance import simulated_drives
from tests.core.worlds import DRIVES, circle, kernel, robot, scene

NEUTRAL = "own_weight: 0, evidence_weight: 0, noise: 0"
ALIKE = "neighborDist: 5, maxNeighbors: 10, timeHorizon: 2, timeHorizonObst: 3, safe_radius: 0.05"


def agent(pose: Any, goal: Any, **overrides: Any) -> core.ObjectSpec:
    keys: dict[str, Any] = {
        "drive": DRIVES["omni"],
        "parts": [circle(0.2)],
        "pose": [*pose, 0.0][:3],
        "goals": [list(goal)],
        "vel_max": [1.0, 1.0],
        "vel_min": [-1.0, -1.0],
    }
    return robot(**{**keys, **overrides})


def watching(behavior: core.AvocadoOptions, *, dt: float = 0.1) -> tuple[core.World, core.State]:
    """A robot that stands still at the origin, without a goal, and one on the x-axis that tests drive by hand."""
    world, state = scene(
        agent((0, 0), (0, 0), behavior=behavior, goals=[]), agent((8, 0), (0, 0), goals=[]), mode=1, step_time=dt
    )
    return world, state


def decide_with(world: core.World, state: core.State, gap: float, velocity: tuple[float, float]) -> Any:
    """Put the other robot at a distance with a velocity, let the first decide, and return its opinion and attention."""
    state.pose[0, :2], state.control[0] = 0.0, 0.0
    state.pose[1, :2], state.control[1, :2] = (gap, 0.0), velocity
    core.decide(world, state)
    (seen,) = state.opinions(0)
    state.count[0] += 1
    assert seen[0] == 1
    return seen[1:]


def test_overlapping_objects_get_full_attention() -> None:
    world, state = watching(kernel("avocado", attention_step=1.0))
    assert decide_with(world, state, 0.3, (0.0, 0.0))[1] == 1.0


def test_opinions_follow_the_equations() -> None:
    """Random velocities of an object ahead, against the equations in plain Python."""
    a, c, d, kappa, gain, delta, b, tau, dt = 0.4, 0.9, 1.5, 3.0, 2.5, 0.4, -0.1, 2.0, 0.1
    behavior = kernel(
        "avocado", own_weight=a, evidence_weight=c, forgetting=d, attention_time=kappa, evidence_gain=gain,
        attention_step=delta, bias=b, timeHorizon=tau,
    )  # fmt: skip
    world, state = watching(behavior, dt=dt)
    rng = np.random.default_rng(5)
    opinion, attention, change, before = b / d, 0.0, np.zeros(2), np.zeros(2)
    for _ in range(60):
        gap, v = rng.uniform(0.6, 4.0), rng.uniform(-1, 1, 2)
        seen = decide_with(world, state, gap, (v[0], v[1]))
        time = contact(np.array([gap, 0.0]), -v, 0.4)
        attention = (1 - delta) * attention + delta * math.tanh(kappa / time)
        evidence = 0.0
        if change.any():
            share = abs((v - before) @ change) / (change @ change)
            evidence = math.tanh(gain * (share - 0.5))
        opinion += dt * (-d * opinion + d * attention * math.tanh(a * opinion + c * evidence) + b)
        assert seen == pytest.approx((opinion, attention), abs=1e-9)
        change, before = leaving(np.array([gap, 0.0]), -v, 0.4, tau), v


def contact(offset: np.ndarray, velocity: np.ndarray, radius: float) -> float:
    """Time until a disc at ``offset`` is touched."""
    roots = np.roots([velocity @ velocity, -2 * (offset @ velocity), offset @ offset - radius**2])
    return float(roots.real.min()) if np.isreal(roots).all() and roots.real.min() > 0 else math.inf


def leaving(offset: np.ndarray, velocity: np.ndarray, radius: float, tau: float) -> np.ndarray:
    """Smallest change that brings a relative velocity to the border of a velocity obstacle, by search on the border."""
    distance = float(np.linalg.norm(offset))
    half = math.asin(radius / distance)
    middle = offset / tau
    heading = math.atan2(offset[1], offset[0])
    w = velocity - middle
    if w @ offset < 0 and (w @ offset) ** 2 > radius**2 * (w @ w):
        return w / np.linalg.norm(w) * (radius / tau) - w
    legs = [np.array([math.cos(heading + s * half), math.sin(heading + s * half)]) for s in (1, -1)]
    leg = legs[0] if offset[0] * w[1] - offset[1] * w[0] > 0 else legs[1]
    return leg * (leg @ velocity) - velocity


@pytest.mark.parametrize(("evidence", "first"), [("neutral", 0.0), ("authors", math.tanh(-0.5 * 2.5))])
def test_evidence_at_first_sight(evidence: str, first: float) -> None:
    """Where nothing was needed before, the released program reads that the other did not give way."""
    a, c, d, dt = 0.4, 0.9, 1.5, 0.1
    behavior = kernel(
        "avocado", own_weight=a, evidence_weight=c, forgetting=d, evidence_gain=2.5, attention_step=1.0,
        evidence=evidence,
    )  # fmt: skip
    world, state = watching(behavior, dt=dt)
    opinion, attention = decide_with(world, state, 1.0, (-0.5, 0.0))
    assert opinion == pytest.approx(dt * d * attention * math.tanh(c * first), abs=1e-12)


@pytest.mark.parametrize("memory", [False, True])
def test_opinions_of_those_who_leave_are_kept_with_memory_only(memory: bool) -> None:
    behavior = kernel("avocado", neighborDist=3.0, attention_step=1.0, bias=0.0, memory=memory, forgetting=2.0)
    world, state = watching(behavior)
    for _ in range(20):  # it comes nearer and does not give way
        before = decide_with(world, state, 2.0, (-0.5, 0.0))
    assert before[0] < -0.3
    state.pose[1, :2] = (30.0, 0.0)
    for _ in range(5):
        core.decide(world, state)
        state.count[0] += 1
    assert [one[1:] for one in state.opinions(0)] == ([before] if memory else [])
    after, _ = decide_with(world, state, 2.0, (-0.5, 0.0))
    assert after == pytest.approx(before[0] * (1 - 0.2) if memory else 0.0, abs=0.15)
    assert (after < -0.3) == memory


@pytest.mark.parametrize(("reaction", "evidence"), [(0.0, -0.5), (0.5, 0.0), (1.0, 0.5)])
def test_opinions_settle_at_the_fixed_point(reaction: float, evidence: float) -> None:
    """The other robot makes none, half or all of the needed change in each step, and stays on a collision course.

    Its velocity goes to and fro by 2 s across the line of sight, and s is such a share of the way to the border of the
    velocity obstacle, whose legs are a half angle beside it.
    """
    world, state = watching(kernel("avocado"))
    half = math.asin(0.4 / 2.0)
    s = reaction * math.tan(half) / (2 + reaction)
    for k in range(120):
        opinion, attention = decide_with(world, state, 2.0, (-1.0, s if k % 2 else -s))
    assert attention == pytest.approx(1.0, abs=1e-6)
    assert opinion == pytest.approx(math.tanh(0.3 * opinion + 0.7 * math.tanh(3.22 * evidence)), abs=1e-6)
    assert np.sign(round(opinion, 6)) == np.sign(evidence)


def meeting(other: str, *, drive: str = "omni", seed: int = 3) -> tuple[list[float], float]:
    """Opinions of a robot that meets another nearly head-on, while a collision was ahead, and the smallest distance."""
    text = f"""
world: {{width: 12, height: 10}}
robot:
  - {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, state: [1, 5, 0], goal: [11, 5],
     behavior: {{name: avocado}}, vel_max: [1, 1], vel_min: [-1, -1]}}
  - {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, state: [11, 5.1, 3.14159], goal: [1, 5.1],
     behavior: {other}, vel_max: [1, 1], vel_min: [-1, -1]}}
"""
    simulation = Simulation(or_raise(read(text, strict=True))[0], [seed])
    opinions, nearest = [], math.inf
    while not simulation.state.done(0):
        simulation.step()
        opinions += [opinion for _, opinion, attention in simulation.state.opinions(0) if attention > 0.8]
        nearest = min(nearest, float(np.hypot(*(simulation.pose[0] - simulation.pose[1])[:2])))
    return opinions, nearest


@pytest.mark.parametrize("drive", ["omni", "diff"])
def test_it_makes_half_for_one_that_gives_way_and_most_for_one_that_does_not(drive: str) -> None:
    def share(opinion: float) -> float:
        return 1 - (opinion + 1) / 2

    mutual, near = meeting("{name: avocado}", drive=drive)
    assert near > 0.4
    assert all(0.4 < share(opinion) < 0.6 for opinion in mutual)
    alone, near = meeting("{name: dash}", drive=drive)
    assert near > 0.4
    assert share(alone[-1]) > 0.75
    assert alone == sorted(alone, reverse=True), "it trusts it less and less"


@pytest.mark.parametrize("drive", simulated_drives())
@pytest.mark.parametrize("shape", ["{name: circle, radius: 0.2}", "{name: rectangle, length: 0.6, width: 0.3}"])
@pytest.mark.parametrize("outer", ["{}", "{{name: follow, local: {}}}"])
def test_with_neutral_opinions_it_is_orca(drive: str, shape: str, outer: str) -> None:
    """Among obstacles and on planned routes, too: margin, noise and parameters alike, and opinions held at 0."""
    features = {"drive": drive, "shape": shape}
    one, two = (
        simulate(scenario_with(**features, behavior=outer.format(inner)), steps=120)[1]
        for inner in (f"{{name: orca, responsibility: 0.5, {ALIKE}}}", f"{{name: avocado, {NEUTRAL}, {ALIKE}}}")
    )
    assert abs(one - two).max() <= 1e-9
    learned = simulate(scenario_with(**features, behavior=outer.format(f"{{name: avocado, {ALIKE}}}")), steps=120)[1]
    assert abs(one - learned).max() > 1e-6, "with opinions it is not"


def test_the_margin_is_a_tenth_of_the_radius() -> None:
    for radius in (0.2, 0.5):
        texts = [
            scenario_with(
                drive="omni", shape=f"{{name: circle, radius: {radius}}}", behavior=f"{{name: avocado{more}}}"
            )
            for more in ("", f", safe_radius: {0.1 * radius!r}")
        ]
        one, two = (simulate(text, steps=120)[1] for text in texts)
        assert abs(one - two).max() < 1e-9


CROWD = """
world: {width: 8, height: 8}
robot:
  - number: 8
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    distribution: {name: circle, center: [4, 4], radius: 3}
    behavior: {name: avocado}
"""


def test_an_object_that_comes_or_goes_leaves_the_other_opinions(tmp_path: Path) -> None:
    path = tmp_path / "crowd.yaml"
    path.write_text(CROWD)
    env = irsim.make(str(path), headless=True, seed=4, log_level="ERROR")
    for _ in range(30):
        env.step()
    before = {view.id: env.simulation.state.opinions(view.index) for view in env.robot_list}
    assert any(before.values())
    env.delete_object(3)
    env.add_object(env.create_obstacle(shape={"name": "circle", "radius": 0.1}, state=[0.5, 0.5, 0]))
    for view in env.robot_list:
        assert env.simulation.state.opinions(view.index) == before[view.id]
    env.step()
    now = {view.id: env.simulation.state.opinions(view.index) for view in env.robot_list}
    assert all(number != 3 for seen in now.values() for number, _, _ in seen)
    kept = [
        (old[1], new[1]) for key in now for old in before[key] for new in now[key] if old[0] == new[0] and old[1] != 0.0
    ]
    assert kept
    assert all(new != 0.0 for _, new in kept), "they go on and do not start anew"


def test_noise_ends_a_deadlock() -> None:
    """A robot straight behind a slower one trails it for ever, unless something breaks the symmetry."""
    text = """
world: {{width: 40, height: 10}}
robot:
  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, state: [1, 5, 0], goal: [20, 5],
     behavior: {{name: avocado, noise: {noise}}}, vel_max: [1, 1]}}
  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, state: [3, 5, 0], goal: [38, 5],
     behavior: {{name: dash}}, vel_max: [0.4, 0.4]}}
"""
    arrived = []
    for noise in (0.0, 1e-4):
        simulation, _ = simulate(text.format(noise=noise), steps=320)
        arrived.append(bool(simulation.state.arrived[0]))
    assert arrived == [False, True]
