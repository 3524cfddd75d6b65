"""Ties: two whose motion is mirrored pass on the right, whatever their drive, and nothing else changes."""

from __future__ import annotations

import math
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from irsim.api import read_scenario
from irsim.compat.differences import CHANGED_SCENES
from tests.core.test_sidestep import LOCALS, RING
from tests.core.worlds import assert_success, collisions

LAWS = ("rvo", "sfm", "orca", "avocado, noise: 0")
DRIVES = ("diff", "omni")
TURNS = (0, 30, 90, 135)
OLD = {
    "rvo": "rvo, sidestep: 0, turning: fixed, keep_gap: false",
    "sfm": "sfm, sidestep: 0, keep_gap: false",
    "orca": "orca, sidestep: 0",
}
Place = tuple[float, float]


def scene(law: str, drive: str, starts: Sequence[Place], goals: Sequence[Place], key: str = "behavior") -> str:
    """Robots that face their goals. `law` is what follows the name of a behavior, too."""
    headings = [math.atan2(g[1] - s[1], g[0] - s[0]) for s, g in zip(starts, goals, strict=True)]
    robots = {
        "number": len(starts),
        "distribution": {"name": "manual"},
        "state": [[*s, heading] for s, heading in zip(starts, headings, strict=True)],
        "goal": [list(g) for g in goals],
        "kinematics": {"name": drive},
        "shape": {"name": "circle", "radius": 0.2},
        "goal_threshold": 0.2,
        key: yaml.safe_load(f"{{name: {law}}}"),
    }
    return yaml.safe_dump({"world": {"width": 20, "height": 20, "time_limit": 90}, "robot": [robots]})


def motion(text: str, steps: int) -> np.ndarray:
    """Poses after every step, shape (steps, robots, 3)."""
    scenario, _ = read_scenario(text=text, strict=False)
    batch = irsim.batch(scenario, 1, seeds=[0])
    poses = []
    for _ in range(steps):
        batch.step()
        poses.append(batch.pose[0].copy())
    return np.asarray(poses)


def test_ties_are_broken_alike_in_every_world_of_a_batch() -> None:
    scenario, _ = read_scenario(text=circle("rvo", "diff", 8), strict=False)
    batch = irsim.batch(scenario, 3, seeds=[0, 0, 0], threads=2)
    for _ in range(80):
        batch.step()
    alone = motion(circle("rvo", "diff", 8), 80)[-1]
    assert all(np.array_equal(pose, alone) for pose in batch.pose)


def head_on(law: str, drive: str, degrees: float, key: str = "behavior") -> str:
    x, y = 6 * math.cos(math.radians(degrees)), 6 * math.sin(math.radians(degrees))
    ends = [(10 - x, 10 - y), (10 + x, 10 + y)]
    return scene(law, drive, ends, ends[::-1], key)


HEAD_ON = [(law, drive, turn, "behavior") for law in LAWS for drive in (*DRIVES, "omni_angular") for turn in TURNS]
HEAD_ON += [(law, "acker", 30, "behavior") for law in ("orca", "avocado, noise: 0")]
HEAD_ON += [(law, "omni", 0, "group_behavior") for law in ("sfm", "orca")]


@pytest.mark.parametrize(("law", "drive", "degrees", "key"), HEAD_ON)
def test_two_that_meet_head_on_pass(law: str, drive: str, degrees: float, key: str) -> None:
    result = assert_success(head_on(law, drive, degrees, key), seed=0)
    assert max(robot.time_to_goal or math.inf for robot in result.robots) < (14 if drive != "acker" else 60)


@pytest.mark.parametrize("count", [2, 3, 5, 7, 8])
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("law", ["avocado", "avocado, noise: 0"])
def test_rings_under_avocado_swap_without_a_contact_at_long_steps_too(law: str, drive: str, count: int) -> None:
    angles = [math.tau * k / count for k in range(count)]
    starts = [(10 + 4 * math.cos(a), 10 + 4 * math.sin(a)) for a in angles]
    document = yaml.safe_load(scene(law, drive, starts, [(20 - x, 20 - y) for x, y in starts]))
    document["robot"][0] |= {"vel_max": [1.5, 1.5], "vel_min": [-1.5, -1.5]}
    for step in (0.1, 0.2):
        document["world"] |= {"step_time": step, "contacts": "swept"}
        result = irsim.run(text=yaml.safe_dump(document), seed=1)
        assert result.outcome == "success", (step, result.reason)


def test_avocado_keeps_gaps_where_it_was_in_a_tie_or_is_told_to() -> None:
    starts, goals = [(4, 10), (10, 4.6)], [(16, 10), (10, 16)]
    usual, never, always = (
        motion(scene(f"avocado, noise: 0{option}", "omni", starts, goals), 100)
        for option in ("", ", keep_gap: false", ", keep_gap: true")
    )
    assert np.array_equal(usual, never)  # nothing is mirrored here
    gap = [np.linalg.norm(path[:, 0, :2] - path[:, 1, :2], axis=1).min() for path in (never, always)]
    assert gap[1] >= gap[0]


@pytest.mark.parametrize("law", OLD)
def test_both_pass_on_their_right(law: str) -> None:
    path = motion(head_on(law, "omni", 0), 60)
    assert path[:, 0, 1].min() < 9.95
    assert path[:, 1, 1].max() > 10.05


@pytest.mark.parametrize("law", OLD)
def test_a_sidestep_of_zero_leaves_ties(law: str) -> None:
    assert irsim.run(text=head_on(OLD[law], "omni", 0), seed=0).outcome != "success"


def circle(law: str, drive: str, count: int) -> str:
    world = {"width": 20, "height": 20, "time_limit": 90}
    text = scene(law, drive, [(10, 10)], [(1, 1)])
    [robot] = yaml.safe_load(text)["robot"]
    for key in ("state", "goal"):
        del robot[key]
    robot |= {"number": count, "distribution": {"name": "circle", "radius": 6, "center": [10, 10]}}
    return yaml.safe_dump({"world": world, "robot": [robot]})


@pytest.mark.parametrize("count", [3, 4, 8, *(pytest.param(n, marks=pytest.mark.slow) for n in (2, 5, 6, 10, 16))])
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("law", OLD)
def test_a_circle_swaps(law: str, drive: str, count: int) -> None:
    result = irsim.run(text=circle(law, drive, count), seed=0)
    expected = "timeout" if law == "sfm" and count == 16 else "success"  # so many hold one another up
    assert result.outcome == expected, result.reason


LOOP = """
world: {{width: {size}, height: {size}, step_time: 0.1, collision_mode: stop, time_limit: 60}}
robot:
  - number: {count}
    distribution: {{name: circle, radius: {radius}, center: [{middle}, {middle}]}}
    kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.2}}
    behavior: {{name: rvo, vxmax: 1.0, vymax: 1.0, acce: 1.0, factor: 2.0, neighbor_threshold: 5.0, loop: true}}
    vel_min: [-3, -3]
    vel_max: [3, 3]
    goal_threshold: 0.2
"""


@pytest.mark.parametrize(("count", "radius"), [(10, 4), (50, 12), (50, 16), (50, 20), (50, 25), (50, 30)])
def test_a_looped_swap_goes_on_for_a_minute_without_a_contact(count: int, radius: float) -> None:
    text = LOOP.format(count=count, radius=radius, size=2 * radius + 2, middle=radius + 1)
    result = irsim.run(text=text, seed=0)
    assert collisions(result) == []


ORDERS = {
    "rvo": ("omni", 5, 1e-6),
    "sfm": ("omni", 5, 1e-6),
    "orca": ("diff", 6, 0.0),
    "orca, maxNeighbors: 2": ("omni", 8, 0.0),
    "orca, safe_radius: 0.05": ("acker", 4, 0.0),
    "avocado, noise: 0": ("diff", 5, 0.0),
    "footprint_orca": ("diff", 6, 0.0),
}
"""Drive and number of robots on a ring for each behavior, and by how much two orders of the file may differ [m]."""


@pytest.mark.parametrize("law", ORDERS)
def test_the_order_of_the_file_does_not_matter(law: str) -> None:
    drive, count, most = ORDERS[law]
    angles = [math.tau * k / count for k in range(count)]
    starts = [(10 + 4 * math.cos(a), 10 + 4 * math.sin(a)) for a in angles]
    goals = [(20 - x, 20 - y) for x, y in starts]
    here = motion(scene(law, drive, starts, goals), 150)
    for order in (list(range(count))[::-1], [*range(1, count, 2), *range(0, count, 2)]):
        there = motion(scene(law, drive, [starts[k] for k in order], [goals[k] for k in order]), 150)
        np.testing.assert_allclose(here[:, order], there, rtol=0, atol=most)


def test_the_order_of_obstacles_does_not_matter() -> None:
    pillars = [{"shape": {"name": "circle", "radius": 0.5}, "state": [10, y]} for y in (9.0, 11.0)]
    boxes = [{"shape": {"name": "rectangle", "length": 1, "width": 1}, "state": [7, y]} for y in (9.1, 10.9)]
    paths = []
    for obstacles in (boxes + pillars, (boxes + pillars)[::-1]):
        document = yaml.safe_load(scene("orca, safe_radius: 0.05", "diff", [(2, 10)], [(18, 10.3)]))
        paths.append(motion(yaml.safe_dump(document | {"obstacle": obstacles}), 200)[:, 0])
    assert np.array_equal(*paths)


@pytest.mark.parametrize("law", ["sfm", "orca"])
def test_a_scene_that_is_turned_moves_as_before(law: str) -> None:
    first, turned = motion(head_on(law, "omni", 0), 100), motion(head_on(law, "omni", 90), 100)
    offset = first[..., :2] - 10
    assert np.allclose(np.stack([-offset[..., 1], offset[..., 0]], -1), turned[..., :2] - 10, atol=1e-6)


TIES_ALONE = {"rvo": "rvo, turning: fixed, keep_gap: false", "sfm": "sfm, keep_gap: false", "orca": "orca"}
"""Behaviors that differ from `OLD` by the law of ties only."""

NO_TIES = {
    "side by side": ([(2, 9), (2, 10)], [(16, 9), (16, 10)]),
    "side by side, slightly inwards": ([(2, 9), (2, 11)], [(16, 9.5), (16, 10.5)]),
    "apart": ([(8, 10), (12, 10)], [(2, 10), (18, 10)]),
    "convoy": ([(2, 10), (3.5, 10), (5, 10)], [(15, 10), (16.5, 10), (18, 10)]),
    "resting": ([(9, 10), (11, 10)], [(9, 10), (11, 10)]),
    "crossing, one later": ([(4, 10), (10, 4.6)], [(16, 10), (10, 16)]),
}


@pytest.mark.parametrize("case", NO_TIES)
@pytest.mark.parametrize("law", OLD)
def test_where_nothing_is_mirrored_nothing_changes(law: str, case: str) -> None:
    ours, theirs = (motion(scene(one, "omni", *NO_TIES[case]), 60) for one in (TIES_ALONE[law], OLD[law]))
    assert np.array_equal(ours, theirs)


RANDOM = """
world: {{width: 12, height: 12, time_limit: 40}}
robot:
  - number: 10
    distribution: {{name: random, range_low: [1, 1, -3.14], range_high: [11, 11, 3.14]}}
    kinematics: {{name: {drive}}}
    shape: {{name: circle, radius: 0.2}}
    behavior: {{name: {law}}}
    goal_threshold: 0.2
"""


@pytest.mark.parametrize("seeds", [range(5), pytest.param(range(5, 50), marks=pytest.mark.slow)])
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("law", OLD)
def test_random_scenes_move_as_before(law: str, drive: str, seeds: range) -> None:
    for seed in seeds:
        ends = [
            [robot.pose for robot in irsim.run(text=RANDOM.format(law=one, drive=drive), seed=seed).robots]
            for one in (TIES_ALONE[law], OLD[law])
        ]
        assert ends[0] == ends[1]


def with_old_law(document: Any) -> Any:
    """A scenario whose behaviors follow the law without ties, where they say nothing else."""
    if isinstance(document, list):
        return [with_old_law(item) for item in document]
    if not isinstance(document, dict):
        return document
    copied = {key: with_old_law(value) for key, value in document.items()}
    for key in ("behavior", "group_behavior", "local"):
        options = copied.get(key)
        if isinstance(options, dict) and options.get("name") in (*OLD, "avocado"):
            options.setdefault("sidestep", 0)
            if options["name"] == "rvo":
                options.setdefault("turning", "fixed")
            if options["name"] in ("rvo", "sfm"):
                options.setdefault("keep_gap", False)
    return copied


ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_scenes_that_changed_are_those_of_the_published_list(tmp_path: Path) -> None:
    changed = []
    for path in [*ROOT.glob("templates/*/scenario.yaml"), *ROOT.glob("tests/parity/scenarios/*.yaml")]:
        document = yaml.safe_load(path.read_text())
        old = with_old_law(document)
        if old == document:
            continue
        folder = tmp_path / path.parent.name
        shutil.copytree(path.parent, folder, dirs_exist_ok=True)
        runs = []
        for one in (document, old):
            (folder / "other.yaml").write_text(yaml.safe_dump(one))
            runs.append(irsim.run(folder / "other.yaml", seed=3, steps=300))
        if [robot.pose for robot in runs[0].robots] != [robot.pose for robot in runs[1].robots]:
            changed.append(path.parent.relative_to(ROOT).as_posix())
    assert sorted(changed) == sorted(CHANGED_SCENES)


@pytest.mark.parametrize("law", LOCALS)
def test_a_ring_opens_without_a_side_being_given(law: str) -> None:
    text = RING.format(count=5, drive="diff", turn=2, behavior=LOCALS[law])
    assert irsim.run(text=text, seed=0).outcome == "success"
