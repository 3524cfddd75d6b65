"""The grader: golds pass, what contradicts a prompt fails with evidence, no answer makes it crash, hang or believe."""

from __future__ import annotations

import errno
import math
import os
import time
from pathlib import Path
from typing import Any

import pytest

from irsim_evals.cases.store import PUBLISHED, case_ids, case_of, golds_of, raw_case, substitute
from irsim_evals.cli.cases import schema_text
from irsim_evals.grader import limited
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.hues import discernible
from irsim_evals.grader.limited import grade_answer, grade_folder, run_limited
from irsim_evals.grader.matching import Match, matches, quantity
from tests.effort import some
from tests.evals.conftest import RIGHT, failed, failures, graded, made_up

CASE = case_of("pub-01")

BOMB = """
a: &a [x, x]
b: &b [*a, *a, *a, *a, *a, *a, *a, *a]
c: &c [*b, *b, *b, *b, *b, *b, *b, *b]
d: &d [*c, *c, *c, *c, *c, *c, *c, *c]
world: [*d, *d, *d, *d, *d, *d, *d, *d]
"""


@pytest.mark.parametrize(
    ("text", "value"),
    [("5.4km/h", 1.5), ("90deg/s", math.pi / 2), ("100 ft", 30.48), ("35 cm", 0.35), (".5", 0.5), ("-2 m/s", -2.0)],
)
def test_quantities(text: str, value: float) -> None:
    assert quantity(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["", "m", "5 parsecs", "1,5 m", "1 2"])
def test_what_is_no_quantity(text: str) -> None:
    with pytest.raises(ValueError, match="is not"):
        quantity(text)


def test_tolerances_go_by_what_is_measured() -> None:
    assert matches(Match(eq=10), 10.19, "length")
    assert not matches(Match(eq=10), 10.21, "length")
    assert matches(Match(eq=0), 0.05, "length")
    assert not matches(Match(eq=8), 8.01, "count")
    assert matches(Match(eq=math.pi), -math.pi + 0.01, "heading")
    assert matches(Match(about=1.0), 1.2, "size")
    assert not matches(Match(ge=1), None, "count")
    assert matches(Match(given=False), None, "name")


def test_expressions_are_replaced_by_values() -> None:
    values = {"n": 3, "r": 0.25}
    assert substitute("$(n)", values) == 3
    assert substitute("[$(n * 2), $(r)]", values) == "[6, 0.25]"
    assert substitute("$(n: words) robots of $(r) m", values) == "three robots of 0.25 m"
    assert substitute("$(r) m", values, "de") == "0,25 m"


@pytest.mark.parametrize("case_id", case_ids(sets=True))
def test_a_case_is_named_like_its_file_and_every_instance_is_valid(case_id: str) -> None:
    assert raw_case(case_id)["id"] == case_id
    instances = [case_of(case_id, seed) for seed in range(8)]
    assert len({str(instance.values) for instance in instances}) > 1 or not raw_case(case_id).get("parameters")
    assert not any("$(" in instance.prompt for instance in instances)


@pytest.mark.parametrize("case_id", some(case_ids(sets=True), 6))
def test_golds_pass_with_other_numbers(case_id: str) -> None:
    """With the numbers of the prompt, ``irsim-evals prove`` grades all of them."""
    instance = case_of(case_id, 1)
    golds = golds_of(instance)
    assert len(golds) >= 2
    for gold in golds:
        verdict = grade(instance, gold)
        assert failures(verdict) == []
        assert verdict.strict


def test_foreign_prompts_say_how_they_were_made() -> None:
    foreign = [case_of(path.stem).case for path in (PUBLISHED.cases / "foreign").glob("*.yaml")]
    assert all(len(case.made) > 40 for case in foreign)
    assert {case.language for case in foreign} == {"en", "de", "es", "zh"}
    assert not {case.id for case in foreign} & set(case_ids())  # they count only if their set is named


@pytest.mark.parametrize(
    ("old", "new", "assertion"),
    [
        ("width: 14, height: 9", "width: 9, height: 14", "world"),
        ("1.5708", "90", "start"),
        ("radius: 0.35", "radius: 0.7", "robot"),
        ("name: diff", "name: omni", "robot"),
        ("[12, 7.5, 0]", "[7.5, 12, 0]", "inside-world"),
        ("[12, 7.5, 0]", "[11, 7.5, 0]", "goal"),
        ("behavior: {name: dash}", "behavior: {name: dash}\nobstacle: [{state: [7, 4, 0]}]", "nothing-else"),
        ("radius: 0.35", "radios: 0.35", "valid"),
        ("  behavior: {name: dash}\n", "", "behavior"),
    ],
)
def test_what_contradicts_the_prompt_fails_with_evidence(old: str, new: str, assertion: str) -> None:
    verdict = graded(CASE, RIGHT.replace(old, new))
    assert not verdict.strict
    [outcome] = [one for one in verdict.failed() if one.assertion == assertion]
    assert outcome.expected
    assert outcome.observed


def test_a_right_answer_passes_and_says_what_was_seen() -> None:
    verdict = graded(CASE, RIGHT)
    assert verdict.strict
    assert verdict.rate == 1.0
    assert {"parse", "schema", "load", "sane", "facts", "behavior"} <= {outcome.stage for outcome in verdict.outcomes}


@pytest.mark.parametrize(
    "text",
    [
        BOMB,
        "world: !!python/object/apply:os.system ['touch /tmp/irsim-evals-was-here']\n",
        "world: {width: 10, height: 10}\nrobot: [{number: 1000000, state: [1, 1, 0]}]\n",
        "world: {width: 1.0e+300, height: 10}\nrobot: [{state: [1, 1, 0]}]\n",
        "world: {width: 10, height: 10, obstacle_map: /etc/passwd}\nrobot: [{state: [1, 1, 0]}]\n",
        "robot: 7\nworld: []\n",
        "\0\0\0",
        "",
    ],
    ids=["bomb", "python object", "a million robots", "huge", "a file elsewhere", "other types", "zeros", "empty"],
)
def test_hostile_texts_are_failed_verdicts(text: str) -> None:
    begin = time.monotonic()
    verdict = grade_answer(CASE, Answer("hostile", {"scenario.yaml": text}, "all assertions passed"))
    assert not verdict.strict
    assert verdict.failed()
    assert time.monotonic() - begin < 30
    assert not Path("/tmp/irsim-evals-was-here").exists()


@pytest.mark.skipif(os.name == "nt", reason="makes a link")
def test_links_and_large_files_are_not_read(tmp_path: Path) -> None:
    (tmp_path / "scenario.yaml").symlink_to("/etc/passwd")
    verdict = grade_folder(CASE, tmp_path)
    assert not verdict.strict
    assert "scenario.yaml is a link, and is not opened" in verdict.failed()[0].observed
    (tmp_path / "scenario.yaml").unlink()
    with (tmp_path / "scenario.yaml").open("wb") as file:
        file.truncate(2**30)  # a gigabyte that takes no space
    verdict = grade_folder(CASE, tmp_path)
    assert not verdict.strict
    assert "bytes" in verdict.failed()[0].observed


def test_a_grading_that_takes_too_long_is_ended() -> None:
    begin = time.monotonic()
    verdict = grade_answer(CASE, Answer("slow", {"scenario.yaml": RIGHT}), seconds=0.001)
    assert not verdict.strict
    assert "took more than" in verdict.outcomes[0].observed
    assert time.monotonic() - begin < 20


@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
@pytest.mark.parametrize(("kind", "most"), [("AS", 6 * 1024**3), ("FSIZE", 64 * 1024**2), ("CORE", 0), ("CPU", 15)])
def test_a_grading_has_limits(kind: str, most: int) -> None:
    import resource

    assert run_limited(resource.getrlimit, (getattr(resource, f"RLIMIT_{kind}"),), 10, "asking")[0] == most


def test_a_process_that_cannot_start_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: object) -> None:
        raise OSError(errno.EAGAIN, "no more processes")

    monkeypatch.setattr(type(limited._context().Process()), "start", full)
    with pytest.raises(OSError, match="no more processes"):
        run_limited(abs, (1,), 10, "work")


def test_an_empty_answer_fails_every_case() -> None:
    for case_id in case_ids():
        assert not grade(case_of(case_id), Answer("nothing")).strict


def test_a_map_beside_the_scenario_is_graded_with_it(tmp_path: Path) -> None:
    from PIL import Image

    picture = Image.new("L", (140, 90), 255)
    picture.paste(0, (65, 0, 75, 60))
    (tmp_path / "scenario.yaml").write_text(
        RIGHT.replace("height: 9}", "height: 9, obstacle_map: walls.png}").replace("dash", "follow")
    )
    verdict = grade_folder(CASE, tmp_path)
    assert "walls.png" in next(o for o in verdict.outcomes if o.assertion == "valid").observed
    picture.save(tmp_path / "walls.png")
    assert failures(grade_folder(CASE, tmp_path)) == []
    (tmp_path / "walls.png").write_bytes(b"\x89PNG no picture")
    assert not grade_folder(CASE, tmp_path).strict


def test_an_episode_may_be_driven_by_another_behavior() -> None:
    episodes = [
        {"seconds": 30, "assert": [{"id": "as-written", "arrive": {"of": "robots"}}]},
        {"seconds": 30, "behavior": "dash", "assert": [{"id": "dash", "arrive": {"of": "robots", "share": 0}}]},
    ]
    wall = "obstacle: [{shape: {name: rectangle, length: 0.5, width: 5}, state: [7, 4.5, 0]}]\n"
    text = RIGHT.replace("dash", "follow") + wall
    assert failures(graded(made_up(episodes=episodes), text)) == []


def test_every_goal_of_an_empty_world_is_reachable() -> None:
    case = made_up({"id": "way", "reachable": {"of": "robots"}})
    assert graded(case, RIGHT).strict


@pytest.mark.parametrize(
    ("behavior", "avoids"), [("{name: follow, local: orca}", True), ("{name: follow}", False), ("{name: sfm}", True)]
)
def test_a_planner_avoids_others_if_what_drives_it_does(behavior: str, avoids: bool) -> None:
    case = made_up({"id": "avoids", "each": {"of": "robots", "has": {"avoids": True}}})
    assert graded(case, RIGHT.replace("{name: dash}", behavior)).strict == avoids


FENCED = f"Here it is:\n```yaml{RIGHT}```\n"
DRAFT = RIGHT.replace("0.35", "0.3")


@pytest.mark.parametrize(
    ("files", "reply", "clear"),
    [
        ({"a.yaml": RIGHT}, "", True),
        ({"scenario.yaml": RIGHT, "draft.yaml": DRAFT}, "", True),
        ({"a.yaml": RIGHT, "b.yaml": DRAFT}, "", False),
        ({"a.yaml": RIGHT, "b.yaml": DRAFT}, "The scenario is in `a.yaml`.", True),
        ({"a.yaml": RIGHT, "b.yaml": DRAFT}, "See a.yaml and b.yaml.", False),
        ({"a.yaml": RIGHT, "copy/a.yaml": RIGHT + "\n"}, "", True),
        ({}, FENCED, True),
        ({}, FENCED + FENCED, True),
        ({}, FENCED.replace("0.35", "0.3") + FENCED, False),
        ({}, FENCED + "The robot alone:\n```yaml\nrobot: {goal: [1, 1, 0]}\n```\n", True),
        ({"scene.json": '{"world": {"width": 14, "height": 9},\n "robot": {"kinematics": {"name": "diff"}, '
          '"shape": {"name": "circle", "radius": 0.35}, "state": [2, 1.5, 1.5708], "goal": [12, 7.5, 0], '
          '"behavior": {"name": "dash"}}}'}, "", True),
    ],
)  # fmt: skip
def test_it_must_be_clear_which_scenario_is_meant(files: dict[str, str], reply: str, clear: bool) -> None:
    assert failed(grade(CASE, Answer("answer", files, reply))) == ([] if clear else ["one-scenario"])


WALL = """
world: {width: 10, height: 10}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 5, 0], goal: [8, 5, 0]}
obstacle:
  - {shape: {name: rectangle, length: 0.2, width: 4.4}, state: [5, 2.2, 0]}
  - {shape: {name: rectangle, length: 0.2, width: 4.4}, state: [5, 7.8, 0]}
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.4}, state: [5, 5, 0], goal: [5, 8, 0]%s}
"""


@pytest.mark.parametrize(("behavior", "passes"), [("", False), (", behavior: {name: dash}", True)])
def test_an_obstacle_that_nothing_drives_plugs_a_doorway(behavior: str, passes: bool) -> None:
    case = made_up({"id": "way", "reachable": {"of": "robots"}}, overlap=True)
    assert graded(case, WALL % behavior).strict == passes


def test_a_compound_of_one_circle_is_a_disc() -> None:
    compound = "{name: compound, parts: [{name: circle, radius: 0.35}]}"
    assert graded(CASE, RIGHT.replace("{name: circle, radius: 0.35}", compound)).strict


def test_a_robot_that_cannot_stand_still_is_not_sane() -> None:
    assert failed(graded(CASE, f"{RIGHT}  vel_min: [0.2, -1]\n")) == ["can-stand"]


def test_colors_differ_only_if_they_look_different() -> None:
    assert discernible(["#1f77b4", "#1f77b5", "#ff7f0e", None, "#000000", "#ffffff", None]) == [
        "#1f77b4", "#ff7f0e", None, "#000000", "#ffffff",
    ]  # fmt: skip


def test_the_schema_of_cases_is_up_to_date() -> None:
    assert Path("schema/eval-case.schema.json").read_text(encoding="utf-8") == schema_text()


@pytest.mark.parametrize(
    ("reply", "there"),
    [
        ("The level is scenario.yaml.", True),
        ("", True),
        ("rvo.yaml is the same with RVO.", False),
        ("It is in levels/rvo.yaml; I did not run it.", False),
        ("I can save it as rvo.yaml. Or I'll write slow.yml, if you like!", True),
        ("I will tell more. See rvo.yaml.", False),
    ],
)
def test_files_that_a_reply_names_are_there(reply: str, there: bool) -> None:
    verdict = grade(
        made_up({"id": "a-name", "says": {"files_there": True}}), Answer("a", {"scenario.yaml": RIGHT}, reply)
    )
    assert ("a-name" not in failed(verdict)) == there


FAR = {"arrive": {"of": "robots", "share": 0}, "says": {"any_of": ["not arrive"]}}


@pytest.mark.parametrize(
    ("ways", "reply", "observed"),
    [
        ([{"arrive": {"of": "robots"}}, FAR], "", ""),
        ([{"arrive": {"of": "robots", "within": 3}}, {"moves": {"of": "robots", "path": {"ge": 5}}}], "", ""),
        ([{"arrive": {"of": "robots", "within": 3}}, {"count": {"of": "robots", "number": 1}}], "", ""),
        ([{"near": {"of": "robots", "to": "all", "distance": 1}}, {"arrive": {"of": "robots"}}], "", ""),
        ([{"each": {"of": "robots", "has": {"x": {"ge": "= obstacles.x"}}}}, {"arrive": {"of": "robots"}}], "", ""),
        ([{"arrive": {"of": "robots", "within": 3}}, FAR], "It does not arrive.", "0%; robot_0: after"),
        ([{"arrive": {"of": "robots"}, "says": {"any_of": ["arrives"]}}, FAR], "It does not arrive.", "100%"),
        ([{"sees": {"of": "robots", "number": 3}}, {"state_at": {"of": "robots", "at": 1, "x": 9}}], "", "robot_0"),
    ],
)
def test_one_of_several_assertions_is_enough(ways: Any, reply: str, observed: str) -> None:
    instance = made_up(episodes=[{"seconds": 30, "assert": [{"id": "either", "any": ways}]}])
    wrong = failures(graded(instance, RIGHT, reply))
    assert [name for name, *_ in wrong] == ["either"] * bool(observed)
    assert observed in "; ".join(seen for *_, seen in wrong)
    assert all(" or " in expected for _, expected, _ in wrong)


@pytest.mark.parametrize(("number", "right"), [(1, True), (2, False)])
def test_one_of_several_facts_of_the_start_is_enough(number: int, right: bool) -> None:
    ways = [{"count": {"of": "robots", "number": number}}, {"sees": {"of": "robots", "number": 1}}]
    assert graded(made_up({"id": "either", "any": ways}), RIGHT).strict == right


@pytest.mark.parametrize(
    ("ways", "what"),
    [
        ([{"cuont": {"of": "robots", "number": 1}}], "no predicate 'cuont'"),
        ([{}], "no predicate ''"),
        ([{"count": {"of": "robots", "number": {"ge": "= robts.x"}}}], "there is no selection 'robts'"),
    ],
)
def test_alternatives_are_known_and_in_their_place(ways: Any, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        made_up({"id": "either", "any": ways})
