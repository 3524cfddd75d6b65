"""Traces: what the core writes down equals what is seen step by step."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.env import Env
from irsim.scenario.read import or_raise, read
from irsim.simulation.simulation import Simulation
from irsim.simulation.trace import Trace, join_traces, next_rows, present_row, record

TEXT = """\
world: {width: 10, height: 10, collision_mode: stop}
robot:
  - number: 3
    shape: {name: circle, radius: 0.2}
    distribution: {name: manual}
    kinematics: {name: diff}
    state: [[1, 1, 0], [9, 9, 3], [5, 1, 1.57]]
    goal: [[9, 9, 0], [1, 1, 0], [5, 9, 0]]
    behavior: {name: dash}
    sensors: [{name: lidar2d, number: 5, range_max: 4}, {name: lidar2d, number: 3, range_max: 2}]
obstacle:
  - {shape: {name: circle, radius: 0.5}, state: [5, 6, 0]}
"""


def simulation(seed: int = 0) -> Simulation:
    return Simulation(or_raise(read(TEXT))[0], [seed])


def seen(steps: int) -> list[dict[str, Any]]:
    """Rows that an onlooker writes down, step by step."""
    watched = simulation()
    rows = []
    for step in range(steps + 1):
        if step:
            watched.step()
        ranges = np.where(watched.valid.astype(bool), watched.ranges, np.inf).astype(np.float32)
        arrays = ("pose", "control", "goal", "arrived", "collided", "stopped")
        rows.append({name: getattr(watched, name).copy() for name in arrays} | {"ranges": ranges})
    return rows


def test_a_trace_is_what_an_onlooker_sees() -> None:
    trace, rows = record(simulation(), 60, until_done=False, scans=True), seen(60)
    assert len(trace) == 61
    assert trace.step.tolist() == list(range(61))
    np.testing.assert_allclose(trace.time, np.arange(61) * 0.1)
    for name in ("pose", "control", "goal", "arrived", "collided", "stopped"):
        np.testing.assert_array_equal(getattr(trace, name), np.array([row[name] for row in rows]), err_msg=name)
    np.testing.assert_array_equal(
        np.concatenate(list(trace.ranges.values()), axis=1), np.array([row["ranges"] for row in rows])
    )
    first = trace.names[0]
    assert list(trace.ranges)[:2] == [f"{first}/0", f"{first}/1"]
    assert [block.shape[1] for block in trace.ranges.values()] == [5, 3] * 3
    assert trace.stopped.any()
    assert np.isinf(trace.ranges[f"{first}/1"]).any()
    assert np.isfinite(trace.ranges[f"{first}/0"]).any()


def test_it_ends_when_the_robots_do() -> None:
    trace = record(simulation(), 10_000)
    assert len(trace) < 1000
    assert (trace.arrived[-1, :3] | trace.stopped[-1, :3]).all()
    assert not (trace.arrived[-2, :3] | trace.stopped[-2, :3]).all()
    assert trace.ranges == {}


def test_pieces_joined_are_the_whole() -> None:
    whole, piecewise = record(simulation(), 50, until_done=False, scans=True), simulation()
    parts = [present_row(piecewise, True)]
    parts += [next_rows(piecewise, steps, until_done=False, scans=True) for steps in (1, 0, 20, 29)]
    assert [len(part) for part in parts] == [1, 1, 0, 20, 29]
    assert_same(join_traces(parts), whole)


def test_python_behaviors_are_traced_alike(tmp_path: Path) -> None:
    import irsim

    @irsim.register_behavior("diff", "test_trace_ahead")
    def ahead(ego_object: Any, external_objects: Any, **kwargs: Any) -> Any:
        return np.array([[0.5], [0.1]])

    path = tmp_path / "ahead.yaml"
    path.write_text(TEXT.replace("{name: dash}", "{name: test_trace_ahead}"), encoding="utf-8")
    watched, recorded = (Env(path, seed=1, headless=True, log_level="ERROR") for _ in range(2))
    poses = [watched.simulation.pose.copy()]
    for _ in range(20):
        watched.step()
        poses.append(watched.simulation.pose.copy())
    trace = record(recorded.simulation, 20, until_done=False, scans=True)
    np.testing.assert_array_equal(trace.pose, np.array(poses))
    assert len(record(recorded.simulation, 0)) == 1


def test_negative_steps_are_refused() -> None:
    with pytest.raises(ValueError, match="0 or more"):
        record(simulation(), -1)


def assert_same(one: Trace, other: Trace) -> None:
    """Bit for bit."""
    for name in ("step", "time", "pose", "control", "goal", "arrived", "collided", "stopped"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    assert one.ranges.keys() == other.ranges.keys()
    for key in one.ranges:
        np.testing.assert_array_equal(one.ranges[key], other.ranges[key])
    assert (one.names, one.step_time) == (other.names, other.step_time)
