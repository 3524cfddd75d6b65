"""The central planner: orders of departure solve scenes that the policy alone does not."""

from __future__ import annotations

from tests.benchmarks.central_planner import scene, share, succeeds


def test_it_solves_a_few_scenes() -> None:
    solved, unsolved = share(10, range(100, 104))
    assert sorted(solved) == [100, 101, 102, 103]
    assert unsolved == []


def test_a_robot_that_never_sets_off_does_not_arrive() -> None:
    text = scene(5)
    assert succeeds(text, 100, [0] * 5, 500)
    assert not succeeds(text, 100, [0, 0, 0, 0, 500], 500)
