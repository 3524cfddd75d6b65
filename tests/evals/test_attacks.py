"""Attacks keep the numbers of a right answer and take away what they are for."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import yaml

from irsim_evals.cases.store import Instance, case_of, golds_of
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.proof.attacks import ATTACKS
from irsim_evals.proof.mutants import attacks_on_answer, mutants_of, mutants_of_answer
from irsim_evals.proof.operators import dump
from irsim_evals.proof.trials import Trial, changes_of, kind_of
from tests.evals.conftest import made_up

ROOM = """
world: {width: 12, height: 8}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [1, 4, 0]
    goal: [11, 5, 0]
    behavior: {name: rvo}
    vel_max: [1, 2]
    sensors: [{name: lidar2d, range_max: 5, angle_range: 2}]
obstacle:
  - {shape: {name: rectangle, length: 0.2, width: 3}, state: [6, 1.5, 0]}
  - {shape: {name: rectangle, length: 0.2, width: 3.5}, state: [6, 6.25, 0]}
"""
"""A robot before a wall with a door from y = 3 to y = 4.5."""
PLAIN = ROOM.replace("    sensors: [{name: lidar2d, range_max: 5, angle_range: 2}]\n", "")
COUNT = {"id": "one", "count": {"of": "robots", "number": 1}}
ARRIVE = {"seconds": 30, "assert": [{"id": "arrives", "arrive": {"of": "robots"}}]}
DOOR = {"id": "door", "doorway": {"start": [6, 0], "end": [6, 8], "middles": [[6, 3.75]]}}


def kinds(operator: str, instance: Instance) -> set[str | None]:
    """The kinds of an operator's mutants of the room for a case; None for one that may be right."""
    room = ROOM if "sensor" in operator else PLAIN
    made = [(what, data) for name, what, data in mutants_of(yaml.safe_load(room)) if name == operator]
    assert made
    answers = [(what, Answer("x", {"s.yaml": dump(data)})) for what, data in made]
    return {
        kind_of(Trial("x", "x", "mutant", operator, what, instance, answer, "s.yaml", room)) for what, answer in answers
    }


@pytest.mark.parametrize(
    ("operator", "assertion", "keys"),
    [
        ("dash_instead", {"id": "avoids", "each": {"of": "robots", "has": {"avoids": True}}}, {}),
        ("goal_at_start", COUNT, {"episodes": [ARRIVE]}),
        ("limits_out_of_reach", COUNT, {"episodes": [ARRIVE]}),
        ("static_movers", COUNT, {"episodes": [ARRIVE]}),
        ("time_up", COUNT, {"episodes": [ARRIVE]}),
        ("doors_elsewhere", DOOR, {}),
        ("walls_with_gaps", DOOR, {}),
        ("sensors_turned", COUNT, {"pins": [{"of": "robots", "facts": "sensors"}]}),
        ("mirror_x", COUNT, {"pins": [{"of": "robots", "facts": "position"}]}),
    ],
)
def test_an_attack_is_wrong_where_a_case_asks_for_what_it_spoils(
    operator: str, assertion: dict[str, Any], keys: dict[str, Any]
) -> None:
    assert kinds(operator, made_up(assertion, **keys)) == {"attack"}
    assert kinds(operator, made_up(COUNT)) == {None}


def test_what_a_prompt_does_not_make_passable_may_not_be() -> None:
    assert kinds("passable_bodies", made_up(COUNT)) == {"attack"}
    free = [{"of": "all", "facts": "passable"}]
    assert kinds("passable_bodies", made_up(COUNT, free=free)) == {None}


def test_a_mirrored_world_is_right_where_that_is_free() -> None:
    pins = [{"of": "robots", "facts": "position"}]
    assert kinds("mirror_x", made_up(COUNT, pins=pins, free=[{"of": "world", "facts": "mirror_x"}])) == {None}


def test_attacks_on_a_room_are_noticed() -> None:
    instance = made_up(COUNT, DOOR, episodes=[ARRIVE])
    assert grade(instance, Answer("right", {"scenario.yaml": ROOM})).strict
    spoilt = ATTACKS.keys() - {"dash_instead", "later", "limits_elsewhere", "sensors_turned"}
    for operator, what, data in mutants_of(yaml.safe_load(ROOM)):
        if operator in spoilt:
            verdict = grade(instance, Answer("attack", {"scenario.yaml": dump(data)}), whole=False)
            assert verdict.strict == (operator in ("mirror_x", "mirror_y")), what


def test_answers_are_attacked_by_files_and_promises() -> None:
    flagged = made_up(COUNT, disposition=["flag"], python="none")
    made = list(attacks_on_answer(flagged, Answer("x", {"scenario.yaml": ROOM}, "It cannot be done.")))
    assert {operator for operator, _, _ in made} == {"hidden_file", "promise"}
    assert any(".cache/run" in answer.files for _, _, answer in made)
    assert list(attacks_on_answer(made_up(COUNT, python="any"), Answer("x"))) == []


ONLY: dict[str, Any] = yaml.safe_load(Path(__file__).with_name("attacks.yaml").read_text(encoding="utf-8"))


def test_each_attack_has_a_case_that_only_it_catches() -> None:
    assert ONLY.keys() == {*ATTACKS, "hidden_file", "promise"}


@pytest.mark.slow(5)
@pytest.mark.rotates(4)
@pytest.mark.parametrize("operator", ONLY)
def test_only_it_catches(operator: str) -> None:
    """Without some assertions the attack is accepted, and no other attack is: only it shows that they are missing."""
    instance, without = case_of(ONLY[operator]["case"]), set(ONLY[operator]["without"])
    accepted = set()
    for trial in (one for gold in golds_of(instance) for one in changes_of(instance, gold, Counter())):
        if trial.operator not in ONLY or (kind_of(trial) if trial.kind == "mutant" else trial.kind) != "attack":
            continue
        if {one.assertion for one in grade(instance, trial.answer).failed()} <= without:
            accepted.add(trial.operator)
    assert accepted == {operator}


@pytest.mark.parametrize(("given", "number"), [(PLAIN, 0), (PLAIN + "# as it was\n", 1)])
def test_an_edit_is_left_out_only_where_there_is_one(given: str, number: int) -> None:
    instance = made_up(COUNT, files={"s.yaml": given})
    made = [operator for operator, *_ in mutants_of_answer(instance, Answer("x", {"s.yaml": PLAIN}), "s.yaml")]
    assert made.count("edit_left_out") == number
