"""Thousands of objects: what each of them costs does not grow with their number, and a heap of them is refused."""

from __future__ import annotations

import time

import pytest

import irsim

_CROWD = """
world: {width: 1000, height: 1000, time_limit: 1}
robot:
  number: %d
  kinematics: {name: omni}
  behavior: {name: dash}
  distribution: {name: random, range_low: [0, 0, -3], range_high: [1000, 1000, 3]}
"""
_HEAP = """
world: {width: 10, height: 10, contacts: %s, collision_mode: %s}
robot: {number: 1500, kinematics: {name: omni}, distribution: {name: circle, radius: 0.01, center: [5, 5]}}
"""


@pytest.mark.parametrize(("contacts", "mode"), [("step_end", "stop"), ("swept", "stop"), ("step_end", "contact")])
def test_a_heap_whose_pairs_would_fill_the_memory_is_refused(contacts: str, mode: str) -> None:
    with pytest.raises(MemoryError, match="more than 1,000,000 pairs of objects touch in one step"):
        irsim.run(text=_HEAP % (contacts, mode), seed=1, steps=2)


@pytest.mark.slow
def test_the_result_of_a_run_of_many_robots_is_made_in_seconds() -> None:
    begin = time.process_time()
    assert len(irsim.run(text=_CROWD % 20_000, seed=1, steps=2).robots) == 20_000
    assert time.process_time() - begin < 60
