"""Arguments of a behavior registered the 2.12 way: the keys of its YAML mapping, no more."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.lib import register_behavior

SCENARIO = """
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 1, 0]
  behavior: {name: parity_cruise, speed: 0.4, target_roles: obstacle}
obstacle:
  - {shape: {name: circle, radius: 0.2}, state: [5, 4, 0]}
"""


def test_a_function_without_keyword_catch_all_gets_the_keys_of_the_file(tmp_path: Path) -> None:
    def cruise(ego_object: Any, external_objects: list[Any], name: str, speed: float, target_roles: str) -> np.ndarray:
        assert name == "parity_cruise"
        assert [other.name for other in external_objects] == ["obstacle_1"]
        return np.array([[speed], [0.1]])

    register_behavior("diff", "parity_cruise")(cruise)
    path = tmp_path / "cruise.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    env = irsim.make(str(path), headless=True, log_level="ERROR")
    env.step()
    assert env.robot.state.ravel().tolist() == pytest.approx([1.04, 1.0, 0.01])
    env.end()
