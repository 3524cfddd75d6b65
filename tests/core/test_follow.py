"""follow: every drive, footprint and local behavior through mazes; why there is no path; stopping in time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.scenario.read import or_raise, read
from irsim.simulation.simulation import Simulation
from tests.core.worlds import assert_success

WALLS = """
  - {shape: {name: rectangle, length: 8, width: 0.2}, state: [4, 2.5, 0]}
  - {shape: {name: rectangle, length: 8, width: 0.2}, state: [6, 5, 0]}
  - {shape: {name: rectangle, length: 8, width: 0.2}, state: [4, 7.5, 0]}
  - {shape: {name: circle, radius: 0.4}, state: [5, 6.2, 0]}
  - {shape: {name: linestring, vertices: [[3, 2.6], [3, 3.6]]}, state: [0, 0, 0]}
"""
DRIVES = {"diff": 2, "omni": 2, "omni_angular": 3, "acker": 2}
SHAPES = {
    "circle": "{name: circle, radius: 0.2%s}",
    "rectangle": "{name: rectangle, length: 0.6, width: 0.3%s}",
    "polygon": "{name: polygon, vertices: [[-0.2, -0.2], [0.3, 0], [-0.2, 0.2], [-0.1, 0]]}",
}


def maze(
    drive: str = "diff",
    shape: str = "circle",
    follow: str = "planner: astar",
    goal: str = "goal: [9, 9, 0]",
    world: str = "",
    walls: str = WALLS,
    top: Sequence[float] = (),
) -> str:
    """A robot that starts at (1, 1), among walls; shapes are named or written."""
    wheelbase = ", wheelbase: 0.4" if drive == "acker" and shape in SHAPES else ""
    outline = SHAPES.get(shape, shape)
    limits = list(top) or [1.0] * DRIVES[drive]
    return (
        f"world: {{width: 10, height: 10{world}}}\nrobot:\n"
        f"  - kinematics: {{name: {drive}{wheelbase}}}\n"
        f"    shape: {outline % wheelbase if '%s' in outline else outline}\n    state: [1, 1, 0]\n    {goal}\n"
        f"    vel_max: {limits}\n    vel_min: {[-v for v in limits]}\n"
        f"    behavior: {{name: follow, {follow}}}\n{f'obstacle:{walls}' if walls else ''}"
    )


def gap(x: float, y: float, width: float, thickness: float = 0.3) -> str:
    """A wall across the world at ``x`` with a gap about ``y``."""
    text = ""
    for low, high in ((0, y - width / 2), (y + width / 2, 10)):
        shape = f"{{name: rectangle, length: {thickness}, width: {high - low}}}"
        text += f"\n  - {{shape: {shape}, state: [{x}, {(low + high) / 2}, 0]}}"
    return text


def simulation(text: str, seed: int = 3) -> Simulation:
    scenario, _ = or_raise(read(text, strict=True))
    return Simulation(scenario, [seed])


@pytest.mark.parametrize("planner", ["jps", "{name: rrt, max_iter: 3000}", "{name: rrt_star, max_iter: 3000}", "prm"])
def test_every_planner(planner: str) -> None:
    assert_success(maze(follow=f"planner: {planner}"), seed=1, steps=1500)


@pytest.mark.parametrize(("width", "fits"), [(0.48, True), (0.39, False)])
@pytest.mark.parametrize("drive", ["diff", "omni"])
def test_a_gap_is_passed_if_the_robot_fits(drive: str, width: float, fits: bool) -> None:
    result = irsim.run(text=maze(drive, walls=gap(5, 5.05, width)), seed=1, steps=900)
    assert (result.outcome == "success") == fits, result.reason


def test_no_path() -> None:
    result = irsim.run(text=maze(goal="goal: [4, 2.5]"), seed=1, steps=50)
    assert result.outcome == "timeout"
    assert [(event.kind, event.step) for event in result.events] == [("no_path", 0)]
    assert result.robots[0].path_length == 0
    assert "no path" in str(result.reason)


def test_a_car_that_left_its_plan_and_finds_no_other_says_so() -> None:
    """Its wheels turn so slowly, and its steps are so long, that it ends where no plan leads on."""
    text = """
world: {width: 10, height: 10, step_time: 0.5}
robot:
  kinematics: {name: acker}
  shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.7}
  state: [1.28, 1.67, 1.62, 0]
  goal: [1.66, 3.9, -0.99]
  acce: [1, 0.15]
  vel_min: [-1, -1]
  behavior: {name: follow}
obstacle: {shape: {name: rectangle, length: 0.74, width: 0.8}, state: [2.12, 4.12, -0.54]}
"""
    result = irsim.run(text=text, seed=1, steps=250)
    assert result.outcome == "timeout"
    assert "there is no path to it" in str(result.reason)


@pytest.mark.parametrize("local", ["dash", "orca", "avocado", "rvo", "sfm"])
@pytest.mark.parametrize("drive", ["diff", "omni", "acker"])
@pytest.mark.parametrize(("speed", "acce", "step_time"), [(1.5, 0.5, 0.05), (2.5, 0.3, 0.1)])
def test_it_stops_in_time_where_braking_takes_long(
    local: str, drive: str, speed: float, acce: float, step_time: float
) -> None:
    """A wall stands 0.5 m behind the goal, and the way leads round another one at the top speed."""
    turn, limit = (speed, acce) if drive == "omni" else (0.8 if drive == "acker" else 2, 4)
    wheelbase = ", wheelbase: 0.35" if drive == "acker" else ""
    text = f"""
world: {{width: 20, height: 10, boundary: walls, step_time: {step_time}, contacts: swept, time_limit: 60}}
robot:
  - kinematics: {{name: {drive}{wheelbase}}}
    shape: {{name: circle, radius: 0.25}}
    state: [2, 5, 0]
    goal: [15, 5]
    goal_threshold: 0.2
    behavior: {{name: follow, local: {{name: {local}}}}}
    vel_max: [{speed}, {turn}]
    vel_min: [{-speed}, {-turn}]
    acce: [{acce}, {limit}]
obstacle:
  - {{shape: {{name: rectangle, length: 1, width: 3}}, state: [10, 4.4, 0]}}
  - {{shape: {{name: rectangle, length: 0.3, width: 2}}, state: [15.65, 5, 0]}}
"""
    result = assert_success(text, seed=1)
    assert not [event for event in result.events if "collision" in event.kind or "contact" in event.kind]


def test_it_stands_at_its_goal_soon_after_it_has_arrived() -> None:
    robot = "{goal: [9, 5], goal_threshold: 0.2, behavior: {name: follow}, acce: [0.5, 0.5]"
    robot += ", kinematics: {name: omni}, vel_max: [1.5, 1.5], vel_min: [-1.5, -1.5], state: [2, 5, 0]}"
    run = simulation(f"world: {{width: 20, height: 10, after_arrival: yield}}\nrobot: {robot}")
    for _ in range(150):
        run.step()
    assert run.state.arrived[0]
    np.testing.assert_allclose(run.pose[0, :2], [9, 5], atol=0.2)
    assert np.abs(run.state.twist[0]).max() < 1e-6


def test_replans_only_for_a_reason() -> None:
    sim = simulation(maze())
    sim.step()
    path = sim.state.route(0)
    assert path is not None
    assert np.allclose(path[[0, -1]], [[1, 1], [9, 9]])
    for _ in range(20):
        sim.step()
    assert np.array_equal(path, sim.state.route(0))
    sim.state.set_goals(0, [[9.0, 1.0]], False)
    sim.step()
    changed = sim.state.route(0)
    assert changed is not None
    assert np.allclose(changed[-1], [9, 1])
    sim.reset()
    assert sim.state.route(0) is None
    sim.step()
    assert np.array_equal(path, sim.state.route(0))


def test_batches_equal_single_runs() -> None:
    text = maze(follow="planner: {name: rrt, max_iter: 3000}")
    scenario, _ = or_raise(read(text, strict=True))
    together = Simulation(scenario, [3, 4, 5], threads=2)
    together.advance(150)
    for k, seed in enumerate((3, 4, 5)):
        alone = simulation(text, seed)
        alone.advance(150)
        assert np.array_equal(alone.pose[0], together.pose[k * together.objects])


def test_waypoints_and_loop() -> None:
    sim = simulation(maze(follow="loop: true", goal="waypoints: [[9, 3.7], [1, 6.2], [1, 1]]"))
    sim.advance(900)
    kinds = [event[0] for event in sim.state.events(0, 0)]
    assert kinds.count("waypoint") >= 3
    assert "arrival" in kinds
    assert "collision" not in kinds


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The walls as a map: 0.1 m per pixel, the top row is y = 10 m."""
    free = np.full((100, 100), 255, dtype=np.uint8)
    for rows, columns in (((24, 26), (0, 80)), ((49, 51), (20, 100)), ((74, 76), (0, 80)), ((59, 65), (47, 53))):
        free[slice(*rows), slice(*columns)] = 0
    path = tmp_path_factory.mktemp("maze") / "maze.png"
    Image.fromarray(free[::-1]).save(path)
    return path


@pytest.mark.parametrize("local", ["dash", "rvo", "orca", "sfm"])
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(
    ("made_of", "shape"), [*(("walls", shape) for shape in SHAPES), ("map", "rectangle"), ("boundary", "polygon")]
)
def test_through_a_maze(made_of: str, drive: str, shape: str, local: str, picture: Path) -> None:
    world = {"walls": "", "map": f", obstacle_map: '{picture}'", "boundary": ", boundary: walls"}[made_of]
    walls = "" if made_of == "map" else WALLS
    result = assert_success(maze(drive, shape, f"local: {local}", world=world, walls=walls), seed=1, steps=700)
    assert local != "dash" or result.sim_time < 45


LONG = "{name: rectangle, length: 1.4, width: 0.3}"
CAR = "{name: rectangle, length: 0.8, width: 0.4, wheelbase: 0.5}"


def between_walls(drive: str, shape: str, local: str, walls: str, top: Sequence[float] = ()) -> str:
    return maze(drive, shape, f"local: {local}", world=", boundary: walls", walls=walls, top=top)


@pytest.mark.parametrize("local", ["dash", "rvo", "orca", "sfm"])
@pytest.mark.parametrize("drive", ["omni", "diff", "omni_angular"])
@pytest.mark.parametrize("walls", [gap(5, 5, 0.5), gap(4, 3, 0.6) + gap(6.5, 7, 0.6), gap(5, 5, 0.6, 4)])
def test_long_and_thin_through_gaps_without_room_to_turn(drive: str, local: str, walls: str) -> None:
    assert_success(between_walls(drive, LONG, local, walls), seed=1, steps=400)


@pytest.mark.parametrize("local", ["dash", "rvo", "orca", "sfm"])
@pytest.mark.parametrize("steering", [1.0, 0.6, 0.4])
def test_a_car_through_gaps_with_its_turning_circle(steering: float, local: str) -> None:
    walls = gap(4, 3, 0.8) + gap(6.5, 7, 0.8)
    assert_success(between_walls("acker", CAR, local, walls, [1.0, steering]), seed=1, steps=400)


@pytest.mark.parametrize(
    ("walls", "steps"), [(gap(5, 5, 0.28), 30), (gap(4, 3, 0.5) + gap(4.8, 7, 0.5), 250)], ids=["gap", "corner"]
)
def test_a_way_that_is_too_narrow_is_said(walls: str, steps: int) -> None:
    """A disc as wide as the body gets round the corner between the walls, the body does not."""
    result = irsim.run(text=between_walls("diff", LONG, "dash", walls), seed=1, steps=steps)
    assert result.outcome == "timeout"
    assert [event.kind for event in result.events] == ["no_path"]
    assert "no path" in str(result.reason)
