"""What a policy declares is checked before it drives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import ArgumentError, InputError, PolicyError
from irsim.policies import Needs, Observations, Policy

SCENE = "world: {time_limit: 1}\nrobot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 5]}\n"


class Still(Policy):
    def act(self, observations: Observations) -> Any:
        return np.zeros((len(observations), 2))


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"output": "velcity"}, "did you mean velocity"),
        ({"needs": {"scan": True}}, "must be irsim.policies.Needs"),
        ({"decision_dt": float("nan")}, "above 0"),
        ({"decision_dt": -1}, "above 0"),
        ({"decision_dt": "0.5"}, "above 0"),
        ({"decision_dt": True}, "above 0"),
    ],
)
def test_what_is_not_possible_is_refused(changes: dict[str, Any], problem: str) -> None:
    policy = type("Odd", (Still,), changes)()
    with pytest.raises(PolicyError, match=problem):
        irsim.run(text=SCENE, policy=policy)


@pytest.mark.parametrize(
    "needs",
    [{"neighbors": 1.5}, {"neighbors": -1}, {"neighbors": 10**12}, {"beams": -2}, {"neighbor_range": float("nan")},
     {"neighbor_range": 0}, {"map_resolution": 0}, {"map_resolution": "fine"}],
)  # fmt: skip
def test_needs_that_cannot_be_observed_are_refused(needs: dict[str, Any]) -> None:
    with pytest.raises(ArgumentError, match=next(iter(needs))):
        Needs(**needs)


@pytest.mark.parametrize("period", [".nan", ".inf", "-1", "soon"])
def test_periods_of_random_are_checked(period: str) -> None:
    with pytest.raises(PolicyError, match="decision_dt"):
        irsim.run(text=SCENE, policy=f"{{name: random, decision_dt: {period}}}")


def test_a_policy_without_a_name_has_that_of_its_class() -> None:
    assert "Still" in irsim.benchmark(SCENE, Still(), 1).behaviors[0]
    with pytest.raises(InputError, match=r"Still\(…\)"):
        irsim.benchmark(SCENE, Still, 1)
