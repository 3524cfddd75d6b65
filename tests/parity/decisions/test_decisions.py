"""Single decisions equal those recorded from the reference implementation, and from RVO2 (../README.md)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import irsim
import irsim._core as core
from irsim.scenario.read import or_raise, read
from irsim.simulation.simulation import Simulation
from tests.core.worlds import DRIVES, circle, kernel, obstacle, polygon, robot
from tests.core.worlds import scene as core_scene
from tests.parity.decisions.orca_group_record import FILE, scenario
from tests.parity.decisions.scenes import FAMILIES, decide, deciders, scene

pytestmark = pytest.mark.one_python

HERE = Path(__file__).resolve().parent
TOLERANCE = 1e-6
"""Largest absolute difference of an executed command: m/s, rad/s."""
EXCEPTIONS: dict[tuple[str, int], str] = {}
"""(family, scene) whose decisions are not reproduced, and why."""
MIN_COMPARED = 20
"""Scenes of each family that no intended difference concerns, at least."""


def is_decided_otherwise(document: dict[str, Any], rows: list[int]) -> bool:
    """Whether static lines (D6) or limited accelerations (D28) let behaviors of the scene choose otherwise."""
    lines = any(entry["shape"]["name"] == "linestring" for entry in document.get("obstacle", ()))
    return lines or any("acce" in document["robot"][row] for row in rows if row < len(document["robot"]))


def with_laws_of_2_12(document: dict[str, Any]) -> dict[str, Any]:
    """The scene with ``turning: fixed`` (D27) and ``keep_gap: false`` (D29), so that robots move as there."""
    for entry in document["robot"]:
        for options in (entry.get("behavior", {}), entry.get("group_behavior", {})):
            if options.get("name") == "rvo":
                options["turning"] = "fixed"
            if options.get("name") in ("rvo", "sfm"):
                options["keep_gap"] = False
    return document


@pytest.mark.slow(6)
@pytest.mark.parametrize("family", FAMILIES)
def test_decisions_equal_the_recorded_ones(family: str, tmp_path: Path) -> None:
    with np.load(HERE / f"{family}.npz") as file:
        owners, commands = file["scene"], file["command"]
    assert len(commands) >= 500
    wrong, compared = {}, 0
    for index in range(FAMILIES[family]):
        document = with_laws_of_2_12(scene(family, index))
        if is_decided_otherwise(document, deciders(family, document)):
            continue
        compared += 1
        ours = decide(irsim, document, deciders(family, document), tmp_path)
        gap = float(np.abs(ours - commands[owners == index]).max())
        if gap > TOLERANCE:
            wrong[family, index] = gap
    assert set(wrong) == {key for key in EXCEPTIONS if key[0] == family}, wrong
    assert compared >= MIN_COMPARED
    assert len(wrong) <= 0.01 * compared


OF_RVO2 = dict(np.load(Path(__file__).with_name("orca.npz")))
SINGLE_PRECISION = 1e-4  # m/s
OTHERWISE_THAN_RVO2 = {
    (41, 4): "nothing is free, and two neighbours in the way are almost in line: single precision loses the vertex",
    (208, 0): "the same",
    (222, 5): "the same; the recorded answer is faster than the agent",
    (328, 6): "the same; the recorded answer is faster than the agent by 0.05 m/s",
    (544, 6): "two edges of a corner are equally near; RVO2 takes them in the order of its search tree",
    (560, 2): "the same",
    (600, 1): "the same",
}
"""(snapshot, agent) of recorded answers that are not reproduced: 7 of 6400. Agents that touch a wall are left out:
their wanted velocity is turned along it (D6)."""


AHEAD = 1e-3
"""Distance [m] of the goals. No wall is before them, so the wanted velocity leads straight on, as in RVO2."""


def before(position: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """A goal in the same direction; the position itself for an agent that is at its goal."""
    way = goal - position
    distance = np.linalg.norm(way)
    return position + way * (AHEAD / distance) if distance >= 0.1 else position


def decide_as_agents(index: int) -> np.ndarray:
    """(AGENTS, 2) velocities of the core for one recorded snapshot."""
    data = {name: values[index].astype(float) for name, values in OF_RVO2.items()}
    reach, most, horizon, horizon_walls, margin, dt = data["options"]
    behavior = kernel(
        "orca", neighborDist=reach, maxNeighbors=int(most), timeHorizon=horizon, timeHorizonObst=horizon_walls,
        safe_radius=margin,
    )  # fmt: skip
    agents = [
        robot(
            drive=DRIVES["omni"],
            parts=[circle(radius)],
            pose=[*position, 0.0],
            control=[*velocity, 0.0],
            vel_max=[top, top, 0.0],
            goals=[before(position, goal)],
            goal_threshold=AHEAD / 2,
            behavior=behavior,
        )
        for radius, position, velocity, top, goal in zip(
            data["radius"], data["position"], data["velocity"], data["top"], data["goal"], strict=True
        )
    ]
    walls = [ring[~np.isnan(ring[:, 0])] for ring in data["walls"]]
    world, state = core_scene(*agents, *(obstacle(parts=[polygon(*w)]) for w in walls if len(w)), step_time=dt, mode=1)
    core.decide(world, state)
    return state.command[: len(agents), :2].copy()


def touches_wall(index: int, agent: int) -> bool:
    """Whether an agent is nearer to a wall than its radius and its margin."""
    rings = [ring[~np.isnan(ring[:, 0])] for ring in OF_RVO2["walls"][index]]
    place = shapely.Point(OF_RVO2["position"][index][agent])
    reach = OF_RVO2["radius"][index][agent] + OF_RVO2["options"][index][4]
    return any(shapely.Polygon(ring).distance(place) < reach for ring in rings if len(ring))


def test_decisions_equal_those_of_rvo2() -> None:
    gaps = np.array(
        [np.abs(decide_as_agents(i) - OF_RVO2["answer"][i]).max(axis=1) for i in range(len(OF_RVO2["answer"]))]
    )
    far = {(int(i), int(k)) for i, k in np.argwhere(gaps > SINGLE_PRECISION)}
    assert {pair for pair in far if not touches_wall(*pair)} == set(OTHERWISE_THAN_RVO2)


OF_GROUPS = dict(np.load(FILE))


OTHERWISE_IN_GROUPS = {(44, 2), (93, 3), (115, 4)}
"""(snapshot, robot) that overlap others so much that nothing is free: single precision finds another of the least bad
velocities, up to 0.005 m/s away. 3 of 720."""


def test_groups_of_orca_take_their_first_step_as_in_2_12() -> None:
    far = set()
    corrected = 0
    for index, velocity in enumerate(OF_GROUPS["velocity"].astype(float)):
        place, goal, options = (OF_GROUPS[name][index].astype(float) for name in ("place", "goal", "options"))
        drive = "omni" if index % 2 else "diff"
        resolved, _ = or_raise(read(scenario(place, goal, options, drive), strict=True))
        simulation = Simulation(resolved, [0])
        simulation.step()
        gap = np.abs(simulation.control[:, :2] - velocity)
        if drive == "diff":
            # 2.12 leaves headings alone that are less than 0.1 rad off, and stops below 0.02 m/s; robots that avoid
            # an object do neither (D11)
            stops = (velocity == 0.0).all(axis=1) & (np.abs(simulation.control[:, 0]) <= 0.02)
            small = ((velocity[:, 1] == 0.0) & (np.abs(simulation.control[:, 1]) <= 0.1 / 0.1)) | stops
            gap[stops, 0] = 0.0
            corrected += int((small & (gap[:, 1] > SINGLE_PRECISION)).sum())
            # the direction of a slow velocity in single precision is uncertain, and is corrected within 0.1 s
            slow = 1e-6 / np.maximum(np.abs(velocity[:, 0]), 1e-2) / 0.1
            gap[:, 1] = np.where(small, 0.0, np.maximum(gap[:, 1] - slow, 0.0))
        far |= {(index, int(k)) for k in np.flatnonzero(gap.max(axis=1) > SINGLE_PRECISION)}
    assert far == OTHERWISE_IN_GROUPS
    assert corrected < 0.2 * OF_GROUPS["velocity"][::2, :, 0].size
