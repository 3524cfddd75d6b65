"""A mistake in a case is reported when the case is read, not when an answer is graded."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from pydantic import ValidationError

from irsim_evals.cases.model import Assertion
from irsim_evals.cases.reading import CaseError
from irsim_evals.cases.schema import case_schema
from irsim_evals.cases.store import Store, case_files, case_ids, instance_of, raw_case
from irsim_evals.cli.choice import chosen
from irsim_evals.grader.properties import PROPERTIES
from tests.effort import some
from tests.evals.conftest import EVALS, RIGHT, irsim_evals, refusal

CASE_TEXT = """\
id: own
title: One robot
category: [basic]
level: 1
prompt: One robot, please.
assert:
  - {id: robots, count: {of: robots, number: 1}}
  - {id: small, each: {of: robots, has: {radius: {le: 0.4}}}}
pins:
  - {of: robots, facts: count}
"""

SLIPS: list[tuple[dict[str, Any], str]] = [
    ({"each": {"of": "robots", "has": {"radus": 0.3}}}, "radius"),
    ({"placed": {"of": "robots", "rows": [{"goalx": 0.3}]}}, "goal_x"),
    ({"distinct": {"of": "robots", "property": "colour", "number": 2}}, "color"),
    ({"states": {"of": "robots", "property": "radus", "about": "radius"}}, "radius"),
    ({"sensor": {"of": "robots", "has": {"range_mx": 4}}}, "range_max"),
    ({"world": {"widht": 10}}, "width"),
    ({"each": {"of": "robots", "has": {"diameter": 0.6}}}, "radius"),
    ({"each": {"of": "robots", "has": {"drive": "diff"}}}, "kinematics"),
    ({"sensor": {"of": "robots", "has": {"beams": 90}}}, "number"),
    ({"each": {"of": "robots", "has": {"acceleration": 0.6}}}, "acce"),
    ({"each": {"of": "robots", "has": {"behavior": "dahs"}}}, "dash"),
    ({"each": {"of": "robots", "has": {"local": {"in": ["dash", "ocra"]}}}}, "orca"),
    ({"each": {"of": "robots", "has": {"kinematics": {"not": ["akcer"]}}}}, "acker"),
    ({"each": {"of": "robots", "has": {"hue": "rde"}}}, "red"),
    ({"each": {"of": "robots", "has": {"arrive_mode": "postion"}}}, "position"),
    ({"placed": {"of": "robots", "rows": [{"x": 2, "shape": "circel"}]}}, "circle"),
    ({"sensor": {"of": "robots", "has": {"name": "lidra2d"}}}, "lidar2d"),
    ({"world": {"collision_mode": "reactve"}}, "reactive"),
    ({"world": {"map": "perln"}}, "perlin"),
    ({"calls": {"tool": "run_epsiode"}}, "run_episode"),
    ({"calls": {"order": ["lookup", "validate"]}}, "validate_scenario"),
    ({"calls": {"tool": "irsim valdate"}}, "irsim validate"),
    ({"edits": {"only": ["robot[0].vel_max[0]", "robot[0].axce"]}}, "acce"),
    ({"edits": {"must": {"robot[0].sensors[0].rnage_max": 4}}}, "range_max"),
]


@pytest.mark.parametrize(("said", "meant"), SLIPS)
def test_a_misspelt_word_is_an_error_that_names_the_nearest(said: dict[str, Any], meant: str) -> None:
    with pytest.raises(ValidationError) as failure:
        Assertion.model_validate({"id": "slip", **said})
    [error] = failure.value.errors()
    assert (error["type"], error["ctx"]["fix"]) == ("unknown-value", f"write {meant}")


def test_an_expression_that_python_cannot_read_is_refused() -> None:
    for said in ({"says": {"any_of": ["(door"]}}, {"files": {"pattern": "*", "number": 1, "lack": ["(a"]}}):
        with pytest.raises(ValidationError, match="is not a regular expression"):
            Assertion.model_validate({"id": "slip", **said})


NUMBERS: list[tuple[dict[str, Any], str]] = [
    ({"each": {"of": "robots", "has": {"radius": {"eq": "3 mters"}}}}, "'3 mters' is not a number with a known unit"),
    ({"count": {"of": "robots", "number": {"in": [2, "three"]}}}, "'three' is not a number with a known unit"),
    ({"world": {"width": [3, True]}}, "True is not a number with a known unit"),
    ({"each": {"of": "robots", "has": {"static": "yse"}}}, "static is true or false"),
    ({"each": {"of": "robots", "has": {"color": "red"}}}, "there is no color 'red'"),
    ({"edits": {"only": ["robot.vel_max"]}}, "'robot.vel_max' does not say which robot"),
    ({"edits": {"only": ["robot[0].name.first"]}}, "there is no key of robot.name 'first'"),
]


@pytest.mark.parametrize(("said", "why"), NUMBERS)
def test_a_value_that_nothing_can_have_is_an_error(said: dict[str, Any], why: str) -> None:
    with pytest.raises(ValidationError, match=re.escape(why)):
        Assertion.model_validate({"id": "slip", **said})


@pytest.mark.parametrize(
    "said",
    [
        {"each": {"of": "robots", "has": {"behavior": {"not": ["replay"]}, "color": "#ff0000", "tags": ["guide"]}}},
        {"each": {"of": "robots", "has": {"radius": "20cm", "goal_x": "= world.width - 1", "loop": {"given": True}}}},
        {"calls": {"tool": "write_*", "order": ["read_file", "irsim run"]}},
        {"edits": {"only": ["obstacle", "obstacle[*].behavior.vmax", "world.obstacle_map.fill", "robot[0].goal[1]"]}},
    ],
)
def test_known_names_are_accepted(said: dict[str, Any]) -> None:
    Assertion.model_validate({"id": "right", **said})


def test_a_misspelt_key_of_the_given_file_may_be_edited() -> None:
    given = {**RIGHT_CASE, "files": {"scenario.yaml": "robot: {goal_treshold: 0.2}\n"}}
    edits = {"only": ["robot[0].goal_treshold"], "must": {"robot[0].goal_treshold": {"given": False}}}
    assert instance_of({**given, "assert": [{"id": "a", "edits": edits}]}).case.id == "own"
    with pytest.raises(CaseError, match="goal_threshold"):
        instance_of({**given, "assert": [{"id": "a", "edits": {"only": ["robot[0].goal_threshld"]}}]})


@pytest.mark.parametrize(
    ("part", "place", "what"),
    [
        ("assert: [{id: a, arrive: {of: robots}}]", "2:10", "'arrive' is about an episode"),
        ("episodes: [{seconds: 3, assert: [{id: a, count: {of: robots, number: 1}}]}]", "2:34", "'count' is about the"),
        ("episodes: [{seconds: 3, behavior: ocra, assert: []}]", "2:35", "fix: write orca"),
        ("episodes: [{seconds: 3, speed: {rbots: 2}, assert: []}]", "2:33", "fix: write robots"),
        ("pins: [{of: world, facts: kinematics}]", "2:8", "'kinematics' is not a fact of world"),
        ("pins: [{of: robtos, facts: size}]", "2:13", "fix: write robots"),
        ("free: [{facts: [name, colour]}]", "2:23", "fix: write color"),
        ("free: [{facts: [colour, drive]}]", "2:25", "fix: write kinematics"),
        ("assert: [{id: a, count: {of: all, number: {min: 1}}}]", "2:44", "fix: rename it to 'ge'"),
        ("assert: [{id: a, swap: {of: all}}]", "2:18", "fix: irsim-evals predicates says what"),
        ("assert: [{id: a, says: {any_of: [x], turn: 2}}]", "2:44", "this turn is later than the last one, 1"),
        ("assert: [{id: a, says: {any_of: [x]}}, {id: a, says: {any_of: [y]}}]", "2:45", "is called 'a', too"),
        ("assert: [{id: a, world: {top: 6, right: '= robots.raduis'}}]", "2:41", "fix: write radius"),
        ("assert: [{id: a, count: {of: all, number: {ge: '= robot.x', le: 2}}}]", "2:48", "fix: write robots"),
        ("assert: [{id: a, files: {pattern: x, number: '= robots.x'}}]", "2:46", "has no world whose properties"),
        ("assert: [{id: a, edits: {base: scenario.yml, same: false}}]", "2:32", "there is no file 'scenario.yml'"),
        ("assert: [{id: a, edits: {only: ['robot[0].axce']}}]", "2:33", "fix: write acce"),
        ("assert: [{id: a, count: {of: all, number: {gt: 1}}}]", "2:44", "fix: rename it to 'ge'"),
        ("episodes: [{seconds: 3, assert: [{id: a, sees: {of: robots, what: statcs}}]}]", "2:67", "write statics"),
        ("category: [geomtry, warehouse]", "2:12", "fix: write geometry"),
        ("assert: [{id: a, inside: {of: all, region: [0, 0, 1]}}]", "2:44", "item 4 is missing"),
        ("assert: [{id: a, every_scenario: {that: [{cuont: {}}]}}]", "2:42", "fix: write count"),
        ("assert: [{id: a, facing: {of: all, toward: nort}}]", "2:44", "fix: write north"),
        ("waived: [{operator: on_top, what: '(', why: w}]", "2:35", "'(' is not a regular expression"),
    ],
)
def test_a_case_that_cannot_be_graded_as_it_is_meant_is_refused(
    part: str, place: str, what: str, tmp_path: Path
) -> None:
    file = written(tmp_path, "own", "{id: own, title: t, category: [basic], level: 1, prompt: p,\n" + part + "}\n")
    code, text = said("check", file)
    assert code == 2
    assert f"{file}:{place}  error" in text
    assert what in text


def test_every_property_has_its_sentence() -> None:
    for name, one in PROPERTIES.items():
        assert one.sentence[0].isupper() or one.sentence.startswith("``"), name
        assert one.sentence.endswith("."), name


def written(folder: Path, name: str, text: str) -> Path:
    """Write a case file."""
    file = folder / f"{name}.yaml"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    return file


def gold(folder: Path, case: str, answer: str, radius: float = 0.35) -> None:
    """Write a gold."""
    place = folder / case / answer
    place.mkdir(parents=True)
    (place / "scenario.yaml").write_text(RIGHT.replace("0.35", f"{radius}"), encoding="utf-8")


def said(*words: object) -> tuple[int, str]:
    done = irsim_evals(*words)
    assert "internal-error" not in done.output
    return done.exit_code, done.output


WRONG = """\
id: slips
title: Slips
category: [basic]
level: 5
promt: hello
parameters:
  width: {default: 3, choose: [2.5, 3]}
let:
  twice: widht * 2
select:
  boxes: {among: solid, shpe: 3, having: {radus: 3}}
assert:
  - {id: a, cuont: {of: robots, number: 1}}
  - {id: b, each: {of: robts, has: {radius: {eqq: 3}}}}
  - {id: c, world: {height: $(heigth)}}
  - {id: d, count: {of: boxes, number: 1}, world: {width: 10}}
  - {id: e, facing: {of: boxes, toward: nort}}
episodes:
  - seconds: long
    assert: [{id: f, arrive: {of: boxs}}]
"""


def test_every_problem_of_a_file_is_said_at_once_with_its_place_and_a_fix(tmp_path: Path) -> None:
    file = written(tmp_path, "slip", WRONG)
    code, text = said("check", file)
    assert code == 2
    for line, column, what in [
        (1, 1, "'prompt' is missing"),
        (1, 5, "the file is called slip, and its id is 'slips'"),
        (4, 8, "'level' must be ≥ 1 and ≤ 4, got 5"),
        (5, 1, "fix: rename it to 'prompt'"),
        (9, 10, "it cannot be computed: expression cannot contain widht"),
        (11, 18, "there is no selection 'solid'"),
        (11, 25, "'shpe' is not a key of 'select.boxes'"),
        (11, 43, "fix: write radius"),
        (13, 13, "fix: rename it to 'count'"),
        (14, 24, "fix: write robots"),
        (14, 46, "fix: rename it to 'eq'"),
        (15, 29, "it cannot be computed: expression cannot contain heigth"),
        (16, 5, "give exactly one predicate"),
        (17, 41, "fix: write north"),
        (19, 14, "'long' is not a number with a unit"),
        (20, 35, "fix: write boxes"),
    ]:
        assert f"{file}:{line}:{column}  error" in text
        assert what in text
    assert "16 errors" in text


RIGHT_CASE: dict[str, Any] = {"id": "own", "title": "t", "category": ["basic"], "level": 1, "prompt": "p"}
COUNT = {"id": "a", "count": {"of": "robots", "number": 1}}
ARRIVE = {"id": "b", "arrive": {"of": "robots"}}
REFUSED: list[tuple[str, Any]] = [
    ("levle", 1),
    ("level", 5),
    ("category", "basic"),
    ("disposition", ["bulid"]),
    ("seeds", []),
    ("assert", [{"id": "a"}]),
    ("assert", [{**COUNT, "world": {"width": 3}}]),
    ("assert", [{"id": "a", "cuont": {"of": "robots", "number": 1}}]),
    ("assert", [{"id": "a", "count": {"of": "robots"}}]),
    ("assert", [{"id": "a", "count": {"of": "robots", "number": {"eqq": 1}}}]),
    ("assert", [{"id": "a", "count": {"of": "robots", "number": {"tol": 1}}}]),
    ("assert", [{"count": {"of": "robots", "number": 1}}]),
    ("assert", [{"id": "a", "each": {"of": "robots", "has": {"radus": 1}}}]),
    ("assert", [{"id": "a", "world": {"widht": 1}}]),
    ("assert", [{"id": "a", "sensor": {"of": "robots", "has": {"range_mx": 1}}}]),
    ("assert", [{"id": "a", "inside": {"of": "robots", "region": [0, 0, 1]}}]),
    ("assert", [{"id": "a", "inside": {"of": "robots", "what": "gaol", "region": [0, 0, 1, 1]}}]),
    ("assert", [{"id": "a", "every_scenario": {"that": [{"cuont": {"of": "robots", "number": 1}}]}}]),
    ("assert", [ARRIVE]),
    ("episodes", [{"seconds": 3, "assert": [COUNT]}]),
    ("episodes", [{"seconds": "long", "assert": [ARRIVE]}]),
    ("episodes", [{"assert": [ARRIVE]}]),
    ("select", {"boxes": {"shpe": "circle"}}),
    ("select", {"boxes": {"having": {"radus": 1}}}),
    ("select", {"cars": {"kinematics": "akcer"}}),
    ("select", {"discs": {"shape": ["circel"]}}),
    ("episodes", [{"seconds": 3, "assert": [{"id": "a", "sees": {"of": "robots", "by": "lidar", "number": 1}}]}]),
    ("pins", [{"of": "robots", "facts": ["kinematic"]}]),
    ("waived", [{"operator": "entry_doubled"}]),
    ("parameters", {"width": {"default": 3}}),
    ("parameters", {"width": {"default": 3, "choose": [1], "between": [1, 3]}}),
    ("drawings", {"plan.png": {"size": [3, 4], "items": [{"kind": "bxo", "at": [1, 2]}]}}),
]


@pytest.fixture(scope="module")
def validator() -> Any:
    return jsonschema.Draft202012Validator(case_schema())


@pytest.mark.parametrize("case_id", some(list(case_files())))
def test_the_schema_accepts_every_case(case_id: str, validator: Any) -> None:
    problems = [f"{error.json_path}: {error.message[:200]}" for error in validator.iter_errors(raw_case(case_id))]
    assert problems == []


@pytest.mark.parametrize(("key", "value"), REFUSED, ids=[f"{number}-{key}" for number, (key, _) in enumerate(REFUSED)])
def test_the_schema_and_the_model_refuse_the_same(key: str, value: Any, validator: Any) -> None:
    right = {**RIGHT_CASE, "assert": [COUNT], "episodes": [{"seconds": "2min", "assert": [ARRIVE]}]}
    assert validator.is_valid(right)
    assert instance_of(right).case.id == "own"
    assert not validator.is_valid({**right, key: value})
    with pytest.raises(CaseError):
        instance_of({**right, key: value})


def test_a_bad_file_is_named_and_the_others_are_used(tmp_path: Path) -> None:
    cases = tmp_path / "cases"
    written(cases, "own", CASE_TEXT)
    written(cases / "more", "other", CASE_TEXT.replace("id: own", "id: other"))
    written(cases, "broken", "id: broken\nprompt: [\n")
    written(cases, "slip", WRONG.replace("slips", "slip"))
    for words in (["cases"], ["export", tmp_path / "out"]):
        code, text = said(*words, "--cases", cases)
        assert code == 2
        assert f"{cases}/broken.yaml:" in text
        assert "left out: broken, slip" in text
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["own"]
    assert {"own", "other"} <= {line.split(" ")[0] for line in said("cases", "--cases", cases)[1].splitlines()}
    code, text = said("check", "--cases", cases)
    assert code == 2
    assert "other.yaml: valid: case other, 2 assertions" in text
    assert "own.yaml: valid: case own, 2 assertions" in text


def test_cases_of_another_folder_are_exported_graded_and_proved(tmp_path: Path) -> None:
    cases, golds = tmp_path / "cases", tmp_path / "answers"
    written(cases, "own", CASE_TEXT)
    written(cases / "more", "other", CASE_TEXT.replace("id: own", "id: other"))
    for case in ("own", "other"):
        gold(golds, case, "one")
        gold(golds, case, "two", 0.34)
    folders = ["--cases", cases, "--golds", golds]
    assert said("cases", "more", "--json", *folders)[1].count('"id"') == 1
    assert said("export", tmp_path / "out", *folders)[0] == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["own"]
    (tmp_path / "out" / "own" / "scenario.yaml").write_text(RIGHT, encoding="utf-8")
    results = tmp_path / "me.json"
    assert said("grade", tmp_path / "out", *folders, "-o", results)[0] == 0
    assert said("check", "--grade", *folders)[0] == 0
    assert said("report", results, "-o", tmp_path / "report", "--no-pictures", *folders)[0] == 0
    (golds / "other" / "two" / "scenario.yaml").write_text("world: {}\n", encoding="utf-8")
    (golds / "own" / "two" / "scenario.yaml").unlink()
    (golds / "own" / "two").rmdir()
    code, text = said("check", "--grade", *folders)
    assert code == 2
    assert f"{golds}/own holds 1 right answer, and each case needs 2" in text
    assert f"{golds}/other/two does not pass: robots: robots: 0" in text


def test_the_golds_of_a_file_lie_beside_it_or_in_the_folder_that_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = written(tmp_path / "mine" / "cases", "own", CASE_TEXT)
    assert f"{tmp_path}/mine/golds/own holds 0 right answers" in said("check", file, "--grade")[1]
    for name, radius in (("one", 0.35), ("two", 0.34)):
        gold(tmp_path / "mine" / "golds", "own", name, radius)
    code, text = said("check", file, "--grade")
    assert (code, f"2 golds in {tmp_path}/mine/golds/own" in text) == (0, True)
    deeper = written(tmp_path / "mine" / "cases" / "more", "own", CASE_TEXT)
    monkeypatch.chdir(deeper.parent)
    assert said("check", "own.yaml", "--grade")[0] == 0
    gold(tmp_path / "others", "own", "three")
    text = said("check", file, "--grade", "--golds", tmp_path / "others")[1]
    assert f"{tmp_path}/others/own holds 1 right answer, and each case needs 2" in text
    assert said("check", EVALS / "cases" / "pub-01.yaml")[0] == 0


def test_without_golds_nothing_is_said_of_idle_assertions(tmp_path: Path) -> None:
    file = written(tmp_path / "cases", "own", CASE_TEXT)
    assert "unbroken" not in said("check", file, "--grade")[1]


def test_a_set_is_proved_and_listed_with_the_cases_and_run_if_it_is_named() -> None:
    store = Store(EVALS / "cases", EVALS / "golds")
    assert set(case_ids(store)) <= set(case_ids(store, sets=True)) <= set(case_files(store))
    assert "library-aisle" not in case_ids(store, sets=True)
    assert len(chosen(["skills"], store)) > len(chosen(["irsim-scenario"], store)) > 4
    assert "did you mean irsim-runner?" in refusal("cases", "irsim-runer")


@pytest.mark.slow(10)
def test_what_is_proved_of_another_folder(tmp_path: Path) -> None:
    written(tmp_path / "cases", "own", CASE_TEXT)
    written(tmp_path / "cases", "slip", WRONG)
    gold(tmp_path / "golds", "own", "one")
    gold(tmp_path / "golds", "own", "two", 0.34)
    code, text = said("prove", "--quick", "--cases", tmp_path / "cases")
    assert code == 1  # this case is too weak: some templates pass it
    assert re.search("gold +gold +4 ", text)
    assert "slip.yaml:1:1  error missing-key" in text
