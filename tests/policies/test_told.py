"""What is said of policies: lists, single ones, which one to take, and converters."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import irsim
from irsim.common.data_files import skills_directory
from irsim.lookup import lookup
from irsim.policies.converters.weights import CONVERTERS
from irsim.policies.description import describe_policy
from irsim.policies.trained import COMMON_NAMES, trained_policies

RESULTS = Path("irsim-benchmark", "results", "policies_of_the_paper.md")


def rows(text: str, start: str) -> list[list[str]]:
    """The cells of the rows of the first table after a text."""
    table = text[text.index(start) :].split("\n\n")[0]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]


@pytest.mark.parametrize("topic", ["which policy", "results", "table 2", "policies_of_the_paper"])
def test_the_measured_tables_are_found(topic: str) -> None:
    found = lookup(topic)
    assert found.topic == "which-policy"
    assert RESULTS.as_posix() in found.text
    assert (skills_directory() / RESULTS).is_file()


def test_a_question_in_words_leads_there() -> None:
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
        found = [re.match(r"([\d.]+) (µs|ms)", cell) for cell in cells]
        costs[policy.strip("`")] = [float(one[1]) * units[one[2]] for one in found if one]
    ratios = {name: [a / b for a, b in zip(cost, costs["orca"], strict=True)] for name, cost in costs.items()}
    assert all(2.5 < ratio < 5.5 for ratio in ratios["footprint_orca"]), "3 to 5 times as long as orca"
    networks = [ratio for name, both in ratios.items() if not name.endswith(("orca", "avocado")) for ratio in both]
    assert 20 < min(networks) < max(networks) < 3500, "20 to 3,000 times as long as orca"


def test_trained_policies_say_what_they_do_not_see() -> None:
    unseen = {name: describe_policy(name).unseen for name in trained_policies()}
    assert {name for name, text in unseen.items() if not text} == {"goal_lidar", "corridor_social"}
    assert {*unseen.values()} == {"", "static obstacles, walls and maps"}
    assert "static obstacles" in str(lookup("sarl").groups["facts"])


def test_common_names_are_those_of_the_suites() -> None:
    for name, policy in COMMON_NAMES.items():
        assert policy in trained_policies()
        assert lookup(name).topic == policy


def test_converters_and_their_options_are_explained() -> None:
    found = lookup("convert")
    for name in CONVERTERS.names():
        assert f"{name}: " in found.text
        assert lookup(f"convert {name}").topic == f"convert {name}"
    [options] = lookup("convert sarl").groups.values()
    assert {"license", "headings", "gamma"} <= {key.name for key in options}


def test_policy_is_the_list_of_policies() -> None:
    assert lookup("policy").topic == "policies"


def test_a_picture_says_which_policy_drives(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text("robot:\n  - {kinematics: {name: diff}, goal: [5, 5, 0], behavior: {name: dash}}\n")
    found = irsim.render(file, tmp_path / "scene.png", policy="sarl")
    assert [row.behavior for row in found.table.rows] == ["policy sarl"]
    assert irsim.render(file, tmp_path / "scene.png").table.rows[0].behavior == "dash"
