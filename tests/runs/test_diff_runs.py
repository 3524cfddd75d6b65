"""``irsim diff-runs``: where two runs part, and in what."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.results.records import RunsDiff
from irsim.runs import RunError

STREET = """\
world: {width: 20, height: 6}
robot:
  - {name: slow, kinematics: {name: diff}, state: [1, 1, 0], goal: [9, 1, 0], behavior: {name: dash}, vel_max: [1, 1]}
  - {name: fast, kinematics: {name: diff}, state: [1, 4, 0], goal: [19, 4, 0], behavior: {name: dash}, vel_max: [2, 1]}
obstacle:
  - {name: crate, state: [18, 1, 0], shape: {name: circle, radius: 0.4}}
"""


def recorded(text: str, seed: int = 0, steps: int = 30) -> str:
    """Id of a recorded run of a scenario."""
    return str(irsim.run(text=text, seed=seed, steps=steps, record=True).run_id)


def parted(difference: RunsDiff) -> list[tuple[str, str]]:
    return [(one.object, one.quantity) for one in difference.parted]


def test_the_same_run_twice_is_equal(workspace: Path) -> None:
    difference = irsim.diff_runs(recorded(STREET), recorded(STREET))
    assert (difference.same, difference.step, difference.parted, difference.setup) == (True, None, [], [])
    assert difference.summary == "the runs are equal in all 30 steps"


def test_a_seed_that_decides_nothing_is_listed_and_does_not_count(workspace: Path) -> None:
    difference = irsim.diff_runs(recorded(STREET, seed=1), recorded(STREET + "# a comment\n", seed=2))
    assert difference.same
    assert [(change.key, change.before, change.after) for change in difference.setup[1:]] == [("seed", 1, 2)]
    scenario = difference.setup[0]
    assert scenario.key == "scenario"
    assert Path(scenario.after).read_text() == STREET + "# a comment\n"
    assert difference.summary.endswith("although scenario and seed differ")


def test_a_limit_parts_runs_when_it_takes_effect(workspace: Path) -> None:
    difference = irsim.diff_runs(recorded(STREET), recorded(STREET.replace("vel_max: [2, 1]", "vel_max: [1.5, 1]")))
    assert (difference.same, difference.step, difference.time) == (False, 1, 0.1)
    assert parted(difference) == [("fast", "x"), ("fast", "control_0")]
    place, control = difference.parted
    assert (place.before, place.after) == (pytest.approx(1.2), pytest.approx(1.15))
    assert place.difference == pytest.approx(-0.05)
    assert (control.before, control.after, control.difference) == (2, 1.5, -0.5)
    assert difference.summary.startswith("the runs part at step 1 (0.1 s): x of 'fast' is 1.2 and 1.15, and 1 more")


def test_objects_are_matched_by_name(workspace: Path) -> None:
    lines = STREET.splitlines(keepends=True)
    turned = "".join([*lines[:2], lines[3], lines[2], *lines[4:]])
    difference = irsim.diff_runs(recorded(STREET), recorded(turned.replace("name: crate", "name: box")))
    assert difference.step is None
    assert not difference.same
    assert [(change.key, change.before, change.after) for change in difference.setup[1:]] == [
        ("objects", ["crate"], ["box"]),
    ]
    assert difference.summary == "all steps that both runs have are equal, but objects differ"


def test_noise_of_a_lidar_is_found_in_its_beams(workspace: Path) -> None:
    sensor = "sensors: [{name: lidar2d, number: 9, range_max: 20, noise: true, std: 0.1}], vel_max: [1, 1]"
    text = STREET.replace("vel_max: [1, 1]", sensor)
    difference = irsim.diff_runs(recorded(text, seed=1), recorded(text, seed=2))
    [one] = difference.parted
    assert (difference.step, one.object) == (0, "slow")
    assert one.quantity.startswith("ranges_0[")
    assert one.beams is not None
    assert 0 < one.beams < 9  # beams that hit nothing are equal
    assert difference.event_counts == (0, 0)


def test_a_run_that_ends_earlier_is_not_equal(workspace: Path) -> None:
    short, long = recorded(STREET, steps=12), recorded(STREET, steps=30)
    difference = irsim.diff_runs(short, long)
    assert (difference.same, difference.step, difference.last_steps) == (False, None, (12, 30))
    assert f"{short} ends with step 12, {long} with 30" in difference.summary


def test_an_arrival_in_one_run_only_is_an_event_of_it(workspace: Path) -> None:
    near = STREET.replace("goal: [9, 1, 0]", "goal: [2, 1, 0]")
    difference = irsim.diff_runs(recorded(near), recorded(STREET))
    assert difference.step == 0
    assert parted(difference) == [("slow", "goal_x")]
    assert [(event.kind, event.object) for event in difference.events_before] == [("arrival", "slow")]
    assert (difference.events_after, difference.event_counts) == ([], (1, 0))


def test_a_line_elsewhere_is_crossed_in_another_step(workspace: Path) -> None:
    def street(x: float) -> str:
        return STREET.replace("height: 6", f"height: 6, zones: [{{name: gate, line: [[{x}, 0], [{x}, 6]]}}]")

    runs = recorded(street(1.55)), recorded(street(1.65))
    difference = irsim.diff_runs(*runs)
    assert (difference.same, difference.step, difference.event_counts) == (False, None, (2, 2))
    done = CliRunner().invoke(app, ["diff-runs", *runs])
    for run, step in zip(runs, (6, 7), strict=True):
        assert f"only in {run}: line_crossing of slow at gate (left to right) at step {step}" in done.stdout


def test_small_differences_are_tolerated_if_asked_for(workspace: Path) -> None:
    first, second = recorded(STREET), recorded(STREET.replace("state: [1, 4, 0]", "state: [1, 4.000001, 0]"))
    assert irsim.diff_runs(first, second).step == 0
    assert irsim.diff_runs(first, second, tolerance=1e-5).same
    for wrong in (-1.0, float("nan")):
        with pytest.raises(RunError, match="bad-argument: tolerance must be a number from 0 on"):
            irsim.diff_runs(first, second, tolerance=wrong)


def test_headings_differ_by_the_smaller_way_around(workspace: Path) -> None:
    text = STREET.replace("state: [1, 1, 0], goal: [9, 1, 0], behavior: {name: dash}", "state: [1, 1, 3.14]")
    difference = irsim.diff_runs(recorded(text), recorded(text.replace("3.14", "-3.14")))
    [heading] = [one for one in difference.parted if one.quantity == "heading"]
    assert heading.difference == pytest.approx(2 * 3.141592653589793 - 6.28)


def test_blocks_do_not_change_what_is_found(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    late = STREET.replace("goal: [9, 1, 0]", "waypoints: [[3, 1, 0], [9, 1, 0]]")
    runs = recorded(late), recorded(late.replace("[9, 1, 0]", "[9, 2, 0]"))
    difference = irsim.diff_runs(*runs)
    assert difference.step is not None
    assert difference.step > 10
    for numbers in (1, 100, 700):
        monkeypatch.setattr("irsim.runs.comparison._BLOCK_NUMBERS", numbers)
        assert irsim.diff_runs(*runs) == difference


def test_the_command_says_it_with_its_exit_code(workspace: Path) -> None:
    same, other = recorded(STREET), recorded(STREET.replace("vel_max: [2, 1]", "vel_max: [1.5, 1]"))
    console = CliRunner()
    done = console.invoke(app, ["diff-runs", same, same])
    assert (done.exit_code, done.stdout) == (0, "the runs are equal in all 30 steps\n")
    done = console.invoke(app, ["diff-runs", same, "last"])
    assert done.exit_code == 1
    assert "the runs part at step 1 (0.1 s)" in done.stdout
    assert "fast" in done.stdout
    done = console.invoke(app, ["diff-runs", same, other, "--json"])
    assert done.exit_code == 1
    assert RunsDiff.model_validate(json.loads(done.stdout)) == irsim.diff_runs(same, other)
    done = console.invoke(app, ["diff-runs", same, "street-000000"])
    assert done.exit_code == 2
    assert "unknown-run" in done.stderr
