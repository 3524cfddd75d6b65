"""Repairs: what needs no guessing is mended in the text, the rest is left for the author."""

from __future__ import annotations

from pathlib import Path

import pytest

from irsim.scenario.mend import mend

BAD = sorted((Path(__file__).parents[1] / "bad").glob("*.yaml"))

FLAWED = """\
# my scene
world:
  widht: 12          # m
  height: 10
  step_time: 1e-1    # s
robot:
  - kinematics: {name: dif}   # two wheels
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    goal: [[9, 1], [9, 9]]    # route
    behaviour: {name: dash, loop: yes, wander: true}
    vel_max: [1.0, 1.5]
    wheels: 3
    # last
obstacle:
  - number: 2.0
    shape: {name: rectangle, lenght: 1, width: 1}
    distribution: {name: random}
    state: [3, 3, 0]  # ignored
"""

MENDED = """\
# my scene
world:
  width: 12          # m
  height: 10
  step_time: 0.1    # s
robot:
  - kinematics: {name: diff}   # two wheels
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    waypoints: [[9, 1], [9, 9]]    # route
    behavior: {name: dash, wander: true}
    vel_max: [1.0, 1.5]
    wheels: 3
    # last
obstacle:
  - number: 2
    shape: {name: rectangle, length: 1, width: 1}
    distribution: {name: random}
    # ignored
"""


def test_mends_slips_and_keeps_every_other_character() -> None:
    mended = mend(FLAWED)
    assert mended.text == MENDED
    assert [item.code for item in mended.reading.errors] == ["unknown-key"]  # 'wheels': nobody knows what was meant
    changes = {repair.change for repair in mended.repairs}
    assert {"renamed 'widht' to 'width'", "wrote 0.1", "wrote diff", "removed 'state'"} <= changes


def test_mending_again_changes_nothing() -> None:
    mended = mend(mend(FLAWED).text)
    assert (mended.text, mended.repairs) == (MENDED, [])


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_never_makes_a_file_worse(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    before = mend(text, path=str(path))
    assert bool(before.repairs) == (before.text != text)
    repaired = {repair.finding.code for repair in before.repairs}
    again = mend(before.text, path=str(path))
    assert again.text == before.text
    assert len(before.reading.errors) <= len(again.reading.errors) or repaired


def test_hints_and_guesses_are_left_alone() -> None:
    text = (
        "world: {width: 10, height: 10}\n"
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0]}\n"  # hint: no behavior
        "obstacle: {shape: {name: polygon, vertices: [[4, 4], [6, 4], [5, 6]]}}\n"  # a warning: where does it stand?
    )
    mended = mend(text)
    assert mended.text == text
    assert {"no-behavior", "default-state"} <= {item.code for item in mended.reading.diagnostics}
