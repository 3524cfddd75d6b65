"""`actuation` of an entry: what the checker says of it, and what reaches each object."""

from __future__ import annotations

from typing import Any

import pytest

from irsim.scenario.model.actuation import Actuation
from irsim.scenario.read import or_raise, read
from tests.scenario.test_checks import findings, obstacle, robot

TAU = {"kinematics": {"name": "diff", "tau": 0.1}}


def test_off_is_the_default() -> None:
    assert findings(robot(actuation=None)) == findings(robot())
    assert not any("actuation" in one for one in findings(robot(actuation={"delay": 0.1, "lag": [0.1, 0.2]})))


@pytest.mark.parametrize(
    ("options", "code", "path"),
    [
        ({"delay": 2.5}, "out-of-range", "delay"),
        ({"delay": [0.1, -0.1]}, "out-of-range", "delay[1]"),
        ({"command_period": -1}, "out-of-range", "command_period"),
        ({"jerk": 0}, "out-of-range", "jerk"),
        ({"lag": 11}, "out-of-range", "lag"),
        ({"dead_band": -0.1}, "out-of-range", "dead_band"),
        ({"noise": "loud"}, "wrong-type", "noise"),
        ({"noise": [0.1, None]}, "wrong-type", "noise[1]"),
        ({"lag": [0.1, 0.2, 0.3]}, "wrong-length", "lag"),
        ({"resolution": [0.1]}, "wrong-length", "resolution"),
        ({"delay": []}, "wrong-length", "delay"),
        ({"dead_time": 0.1}, "unknown-key", "dead_time"),
    ],
)
def test_values_out_of_place_are_errors(options: dict[str, Any], code: str, path: str) -> None:
    assert f"error {code} robot[0].actuation.{path}" in findings(robot(actuation=options))


def test_a_list_for_one_control_is_mended_to_a_number() -> None:
    [problem] = [d for d in read(robot(actuation={"lag": [0.2]}), strict=True).diagnostics if d.severity == "error"]
    assert problem.message == "'lag' of 'diff' must be one number, or a list of 2 (linear, angular), got 1"
    assert problem.fix == "lag: 0.2"


def test_a_wrong_name_is_told_the_right_one() -> None:
    [problem] = [d for d in read(robot(actuation={"latency": 0.2}), strict=True).diagnostics if d.severity == "error"]
    assert problem.fix == "rename it to 'delay'"


def test_a_lag_given_twice_is_an_error_with_its_fix() -> None:
    twice = robot(**TAU, actuation={"lag": 0.2})
    [problem] = [d for d in read(twice, strict=True).diagnostics if d.severity == "error"]
    assert (problem.code, problem.fix) == ("lag-twice", "remove 'tau', or this lag")
    assert "'tau' of its kinematics is 0.1" in problem.message
    everywhere = {"world": {"drive_tau": 0.3}, **robot(actuation={"lag": [0.0, 0.2]})}
    assert "error lag-twice robot[0].actuation.lag" in findings(everywhere)
    for fine in (
        robot(**TAU, actuation={"delay": 0.2}),
        robot(**TAU, actuation={"lag": 0}),
        {"world": {"drive_tau": 0.3}, **robot(kinematics={"name": "diff", "tau": 0}, actuation={"lag": 0.2})},
    ):
        assert not any("lag-twice" in one for one in findings(fine))


@pytest.mark.parametrize(
    "data",
    [
        obstacle(actuation={"delay": 0.1}),
        robot(static=True, behavior=None, actuation={"delay": 0.1}),
        {"world": {"step_mode": "external"}, **robot(actuation={"delay": 0.1})},
        obstacle(
            kinematics={"name": "omni_angular"}, actuation={"delay": 0.1},
            behavior={"name": "replay", "times": [0, 5], "poses": [[1, 1, 0], [4, 4, 0]]},
        ),
    ],
)  # fmt: skip
def test_actuation_without_effect_is_a_warning(data: dict[str, Any]) -> None:
    assert any(one.startswith("warning actuation-unused") for one in findings(data))


def test_a_period_within_a_step_is_told() -> None:
    assert "hint actuation-unused robot[0].actuation.command_period" in findings(
        robot(actuation={"command_period": 0.1})
    )
    assert not any("actuation" in one for one in findings(robot(actuation={"command_period": 0.11})))


@pytest.mark.parametrize("options", [{"dead_band": 1.1}, {"resolution": 2.1}])
def test_actuators_that_let_nothing_through_are_told(options: dict[str, Any]) -> None:
    [key] = options
    assert f"warning no-speed robot[0].actuation.{key}" in findings(robot(actuation=options))
    assert not any("no-speed" in one for one in findings(robot(actuation={key: options[key] - 0.2})))


def test_each_object_of_an_entry_may_have_its_own() -> None:
    given = {"number": 3, "distribution": {"name": "circle", "radius": 3}}
    scenario, _ = or_raise(read(robot(**given, actuation=[{"lag": 0.1}, None])))
    assert [record.actuation for record in scenario.objects] == [Actuation(lag=0.1), None, None]
    scenario, _ = or_raise(read(robot(**given, actuation={"lag": 0.1})))
    assert [record.actuation for record in scenario.objects] == [Actuation(lag=0.1)] * 3


def test_behaviors_that_react_late_are_told() -> None:
    def told(behavior: str, **actuation: Any) -> list[str]:
        data = {**robot(behavior={"name": behavior}, actuation=actuation), **obstacle(state=[5, 2, 0])}
        return [d.message for d in read(data, strict=True).diagnostics if d.code == "reacts-late"]

    assert told("orca", delay=[0.1, 0.2], lag=0.1, command_period=0.2) == [
        "'robot_0' drives 0.5 m before a command takes effect (0.5 s); orca does not reckon with that"
    ]
    assert told("orca", delay=0.04) == told("dash", delay=0.5) == told("orca", noise=0.1) == []
    alone = robot(behavior={"name": "orca"}, actuation={"delay": 0.5})
    assert not any("reacts-late" in one for one in findings(alone))
