"""Exports to CommonRoad, read again by commonroad-io: static obstacles, trajectories and planning problems."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irsim.bridges.export.export import export_run
from irsim.bridges.recorded import recorded_scene, recorded_states
from tests.interop.usd_run import record

pytestmark = pytest.mark.interop
pytest.importorskip("commonroad")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return record(tmp_path_factory.mktemp("commonroad"))


def test_commonroad_reads_what_was_simulated(run, tmp_path) -> None:
    from commonroad.common.file_reader import CommonRoadFileReader

    target = tmp_path / "run.xml"
    result = export_run(run, target, to="commonroad")
    assert "the map was left out" in " ".join(result.notes)
    scenario, problems = CommonRoadFileReader(str(target)).open()
    assert scenario.dt == 0.1
    scene, states = recorded_scene(run), list(recorded_states(run))
    kinds = {item.obstacle_type.value for item in scenario.dynamic_obstacles}
    assert kinds == {"unknown", "pedestrian"}
    [walker] = [item for item in scenario.dynamic_obstacles if item.obstacle_type.value == "pedestrian"]
    assert (walker.initial_state.time_step, walker.prediction.trajectory.final_state.time_step) == (4, 40)
    robots = [item for item in scenario.dynamic_obstacles if item.obstacle_type.value == "unknown"]
    for item, index in zip([walker, *robots], [5, 0, 1], strict=True):
        for state in states:
            x, y, yaw = state.pose[index]
            read = item.state_at_time(state.step)
            assert (read is None) == math.isnan(x)
            if read is not None:
                np.testing.assert_allclose(read.position, [x, y], atol=2e-9)
                assert math.remainder(read.orientation - yaw, math.tau) == pytest.approx(0, abs=2e-9)
    assert walker.prediction.trajectory.state_at_time_step(12).velocity == pytest.approx(2.5, abs=1e-6)
    assert {problem.initial_state.position[0] for problem in problems.planning_problem_dict.values()} == {1.0, 2.0}
    assert scene.agent("walker").moves


def test_static_bodies_are_where_they_were(run, tmp_path) -> None:
    from commonroad.common.file_reader import CommonRoadFileReader

    export_run(run, tmp_path / "run.xml", to="commonroad")
    scenario, _ = CommonRoadFileReader(str(tmp_path / "run.xml")).open()
    placed = [item.occupancy_at_time(0).shapely_object for item in scenario.static_obstacles]
    u_shape = 1.5 * 1.5 - 0.5
    assert len(placed) == 1 + 2 + 1 + 4, "a U, two legs of a wall, a disc, four walls around the world"
    [disc] = [item for item in scenario.static_obstacles if hasattr(item.obstacle_shape, "radius")]
    assert disc.obstacle_shape.radius == pytest.approx(0.3)
    np.testing.assert_allclose(disc.initial_state.position, [4.1, 7.0], atol=2e-9)
    [concave] = [shape for shape in placed if shape.area == pytest.approx(u_shape, abs=2e-3)]
    assert concave.bounds[:2] == pytest.approx((6 - 1.5 * math.sin(0.3), 6.0), abs=1e-6)
