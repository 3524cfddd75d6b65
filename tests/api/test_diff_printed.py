"""The printed form of a difference."""

from __future__ import annotations

import re
from pathlib import Path

from typer.testing import CliRunner

from irsim.cli.app import app


def test_drawn_places_are_printed_to_the_millimetre(tmp_path: Path) -> None:
    text = """
world: {width: 12, height: 12}
robot: {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash},
  distribution: {name: random, range_low: [1, 1, -3]}}
"""
    before, after = tmp_path / "a.yaml", tmp_path / "b.yaml"
    before.write_text(text)
    after.write_text(text.replace("[1, 1, -3]", "[1.5, 1, -3]"))
    printed = CliRunner().invoke(app, ["diff", str(before), str(after)]).stdout
    assert re.search(r"robot_0 pose  \[[\d., -]+\] -> \[", printed)
    assert not re.search(r"\d\.\d{4}", printed)
