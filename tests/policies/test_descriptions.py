"""Texts about policies: lists, single ones, which one to take, and converters."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.common.data_files import skills_directory
from irsim.diagnostics.errors import ArgumentError, InputError, PolicyError
from irsim.lookup import lookup
from irsim.policies import Needs, Observations, Policy
from irsim.policies.converters.convert import CONVERTERS
from irsim.policies.description import describe_policy
from irsim.policies.trained import COMMON_NAMES, trained_policies

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


RESULTS = Path("irsim-benchmark", "results", "policies_of_the_paper.md")


def rows(text: str, start: str) -> list[list[str]]:
    """The cells of the rows of the first table after a text."""
    table = re.split(r"\n\n|\n<!--", text[text.index(start) :])[0]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]


@pytest.mark.parametrize("topic", ["which policy", "results", "table 2", "policies_of_the_paper"])
def test_the_measured_tables_are_found(topic: str) -> None:
    answer = lookup(topic)
    assert answer.topic == "which-policy"
    assert RESULTS.as_posix() in answer.text
    assert (skills_directory() / RESULTS).is_file()
    assert lookup("which policy avoids collisions best").groups["topics"][0].name == "which-policy"


def test_what_is_said_of_the_tables_is_what_they_say() -> None:
    text = (skills_directory() / RESULTS).read_text(encoding="utf-8")
    success = {
        (protocol, policy): [int(cell.split("/")[0]) for cell in cells]
        for protocol, policy, *cells in rows(text, "| protocol | policy | 5 |")
    }
    for protocol in ("freeze", "yield"):
        best = success[protocol, "`footprint_orca`"]
        others = [shares for (one, _), shares in success.items() if one == protocol]
        assert all(a >= b for shares in others for a, b in zip(best, shares, strict=True))
    units = {"µs": 1.0, "ms": 1000.0}
    costs: dict[str, list[float]] = {}
    for policy, *cells in rows(text, "| policy | 10 robots | 25 robots |"):
        matches = [re.match(r"([\d.]+) (µs|ms)", cell) for cell in cells]
        costs[policy.strip("`")] = [float(one[1]) * units[one[2]] for one in matches if one]
    ratios = {name: [a / b for a, b in zip(cost, costs["orca"], strict=True)] for name, cost in costs.items()}
    assert all(2.5 < ratio < 5.5 for ratio in ratios["footprint_orca"]), "3 to 5 times as long as orca"
    networks = [ratio for name, both in ratios.items() if not name.endswith(("orca", "avocado")) for ratio in both]
    assert 20 < min(networks) < max(networks) < 3500, "20 to 3,000 times as long as orca"


def test_trained_policies_say_what_they_do_not_see() -> None:
    unseen = {name: describe_policy(name).unseen for name in trained_policies()}
    assert {name for name, text in unseen.items() if not text} == {"goal_lidar", "goal_lidar_noisy", "corridor_social"}
    assert {*unseen.values()} == {"", "static obstacles, walls and maps"}
    assert "static obstacles" in str(lookup("sarl").groups["facts"])


def test_common_names_are_those_of_the_suites() -> None:
    assert {*COMMON_NAMES.values()} <= {*trained_policies()}
    assert {name: lookup(name).topic for name in COMMON_NAMES} == dict(COMMON_NAMES)


def test_converters_and_their_options_are_explained() -> None:
    assert lookup("policy").topic == "policies"
    answer = lookup("convert")
    for name in CONVERTERS.names():
        assert f"{name}: " in answer.text
        assert lookup(f"convert {name}").topic == f"convert {name}"
    [options] = lookup("convert sarl").groups.values()
    assert {"license", "headings", "gamma"} <= {key.name for key in options}


def test_a_picture_says_which_policy_drives(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text("robot:\n  - {kinematics: {name: diff}, goal: [5, 5, 0], behavior: {name: dash}}\n")
    picture = irsim.render(file, tmp_path / "scene.png", policy="sarl")
    assert [row.behavior for row in picture.table.rows] == ["policy sarl"]
    assert irsim.render(file, tmp_path / "scene.png").table.rows[0].behavior == "dash"
