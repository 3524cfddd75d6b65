"""``irsim-evals report``: files that are right, page that is harmless whatever agents wrote."""

from __future__ import annotations

import json
import math
import re
import time
from collections.abc import Sequence
from html.parser import HTMLParser
from pathlib import Path

import pytest

from irsim.common.text import escape_marks
from irsim_evals.cases.store import case_of, golds_of
from irsim_evals.grader.artefact import Answer, find_scenario
from irsim_evals.grader.grade import grade
from irsim_evals.grader.outcome import NOT_REACHED, Cost, Mark, Outcome
from irsim_evals.report.content import content_of
from irsim_evals.report.drawing import draw_answer
from irsim_evals.report.html_text import code, difference, lines_of, number, prose
from irsim_evals.report.load import asked_of, load_results
from irsim_evals.report.marked_picture import marked_picture
from irsim_evals.report.page import page
from irsim_evals.report.pictures import Drawn, Job, draw_trials
from irsim_evals.report.summary import summarize
from irsim_evals.results import Results, Trial, results_of, trial_of
from tests.evals.conftest import file_of, irsim_evals, refusal, trial

HOSTILE = "</pre></script><script>alert(1)</script><img src=x onerror=alert(2)>\u202e\x1b[31m"


def written(tmp_path: Path, *trials: Trial, options: Sequence[object] = ()) -> Path:
    """Folder of the report on a file with these trials."""
    results = file_of(tmp_path / "r.json", *trials)
    done = irsim_evals("report", results, "-o", tmp_path / "out", "--no-pictures", *options)
    assert done.exit_code == 0, done.output
    return tmp_path / "out"


def report_of(*trials: object, pictures: bool = False) -> str:
    return page(content_of(Results(cases="abc", trials=list(trials)), pictures=pictures))


class Elements(HTMLParser):
    """Names of all elements, their attributes, and the text outside of scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.words = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.append(tag)
        self.attributes += [(name, value or "") for name, value in attrs]

    def handle_data(self, data: str) -> None:
        if self.names and self.names[-1] not in ("script", "style"):
            self.words += data


def test_numbers_of_damaged_results_may_be_of_any_size() -> None:
    assert [number(value) for value in (0.1234, 1234.5, 10**400)] == ["0.123", "1,234", "1.00e+400"]


def test_report_writes_three_files(tmp_path: Path) -> None:
    results = file_of(tmp_path / "r.json", trial("one", True), trial("two", False), trial("one", False, "rules"))
    done = irsim_evals("report", results, "-o", tmp_path / "out", "--no-pictures")
    assert done.exit_code == 0, done.output
    assert "skill: 50 % of 2 cases pass (9 to 91)" in done.output
    text = (tmp_path / "out" / "report.md").read_text()
    assert "| skill | 2 | 50 % | 9 % to 91 % |" in text
    assert "- two, parameters: size: expected radius 0.2; observed radius 0.3" in text
    words = Elements((tmp_path / "out" / "report.html").read_text()).words
    assert "Prompt of two" in words
    assert "radius 0.3" in words


def test_results_json_has_the_names_of_skill_creator(tmp_path: Path) -> None:
    cost = Cost(calls=4, errors=1, tokens=1200, seconds=8.5)
    data = json.loads((written(tmp_path, trial("one", False, cost=cost)) / "results.json").read_text())
    (one,) = data["runs"]
    assert (one["eval_id"], one["configuration"], one["run_number"]) == ("one", "skill", 1)
    assert one["expectations"][-1] == {"text": "size: radius 0.2", "passed": False, "evidence": "radius 0.3"}
    assert (one["result"]["tool_calls"], one["result"]["failed"]) == (4, 1)
    assert data["run_summary"]["skill"]["tokens"]["mean"] == 1200
    assert data["aggregates"]["arms"]["skill"]["cost_per_pass"]["tokens"] is None


def test_a_report_can_be_read_again(tmp_path: Path) -> None:
    folder = written(tmp_path, trial("one", True), trial("two", False))
    assert load_results(folder) == load_results(tmp_path / "r.json")
    assert irsim_evals("report", folder, "-o", tmp_path / "again", "--no-pictures").exit_code == 0


def test_different_cases_are_not_mixed(tmp_path: Path) -> None:
    a, b = (file_of(tmp_path / f"{cases}.json", trial("one", True), cases=cases) for cases in ("abc", "def"))
    assert "different cases (abc and def)" in refusal("report", a, b, "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_attempts_of_several_files_are_numbered_on(tmp_path: Path) -> None:
    a, b = (file_of(tmp_path / name, trial("one", name == "a")) for name in ("a", "b"))
    done = irsim_evals("report", a, b, "-o", tmp_path / "out", "--no-pictures", "--json")
    arm = json.loads(done.stdout)["arms"]["skill"]
    assert (arm["cases"], arm["trials"]) == (1, 2)
    assert arm["pass_hat"] == {"1": 0.5, "2": 0.0}


@pytest.mark.parametrize(("text", "message"), [("{", "not the JSON of a proof"), ('{"rows": 3}', "rows")])
def test_a_proof_that_is_none(tmp_path: Path, text: str, message: str) -> None:
    results = file_of(tmp_path / "r.json", trial("one", True))
    (tmp_path / "proof.json").write_text(text)
    assert message in refusal("report", results, "--proof", tmp_path / "proof.json", "-o", tmp_path / "out")


def test_the_proof_is_summed_up(tmp_path: Path) -> None:
    rows = [
        {"kind": "gold", "operator": "gold", "trials": 40, "wrong": 0},
        {"kind": "rewrite", "operator": "reordered", "trials": 160, "wrong": 2},
        {"kind": "pinned mutant", "operator": "halved", "trials": 500, "wrong": 1},
    ]
    wrong = [{"case": "pub-05", "gold": "line", "kind": "pinned mutant", "operator": "halved", "what": "robot[0]"}]
    (tmp_path / "proof.json").write_text(json.dumps({"rows": rows, "wrong": wrong, "cases": [], "seconds": 3.0}))
    folder = written(tmp_path, trial("one", True), options=["--proof", tmp_path / "proof.json"])
    words = Elements((folder / "report.html").read_text()).words
    assert "wrong answers accepted, of 500: 1 (0.20%" in words
    assert "right answers rejected, of 200: 2 (1.00%" in words
    assert "pub-05 line pinned mutant halved: robot[0]" in words


def test_nothing_that_somebody_wrote_becomes_markup() -> None:
    one = trial(HOSTILE, False, HOSTILE, reply=HOSTILE, files={HOSTILE: HOSTILE, "scenario.yaml": f"world: {HOSTILE}"})
    one.prompt = one.title = one.hard = one.family = HOSTILE
    one.category = [HOSTILE]
    one.verdict.outcomes[-1].assertion = one.verdict.outcomes[-1].observed = HOSTILE
    one.verdict.outcomes[-1].yaml_path = HOSTILE
    elements = Elements(report_of(one))
    assert elements.names.count("script") == 2
    assert "img" not in elements.names
    assert not [name for name, _ in elements.attributes if name.startswith("on")]
    assert "<script>alert(1)</script>" in elements.words
    assert "\u202e" not in elements.words
    assert "\x1b" not in elements.words


def test_the_page_needs_nothing_else() -> None:
    text = report_of(trial("one", True))
    elements = Elements(text)
    addresses = [value for name, value in elements.attributes if name in ("src", "href", "srcset", "action")]
    assert all(value.startswith(("data:", "#")) for value in addresses)
    policy = next(value for name, value in elements.attributes if name == "content" and "default-src" in value)
    assert policy.startswith("default-src 'none'")
    assert "unsafe" not in policy


def test_funnel_and_cost() -> None:
    trials = [
        trial("one", True, cost=Cost(tokens=100)),
        trial("two", False, stage="behavior", cost=Cost(tokens=300)),
        trial("three", False, stage="facts"),
    ]
    summary = summarize(trials, "skill")
    passed = [summary.funnel[stage].passed for stage in ("sane", "facts", "relations", "behavior", "reply")]
    assert passed == [3, 2, 2, 1, 1]
    assert (summary.cost.known, summary.cost.per_pass) == (2, {"tokens": 400})


def test_costs_that_cannot_be_are_left_out() -> None:
    costs = [Cost(tokens=10**400), Cost(tokens=5, seconds=math.inf), Cost(tokens=7, dollars=1e308)]
    summary = summarize([trial(str(k), True, cost=cost) for k, cost in enumerate(costs)], "skill")
    assert summary.cost.totals == {"tokens": 12}


def test_lines_of_a_path() -> None:
    text = "world: {width: 8}\nrobot:\n  - state:\n      - 1\n      - 2\n    goal: [3, 4]\n"
    lines = lines_of(text, {"robot[0].state", "robot[0].goal", "robot[0].shape.radius", "elsewhere"})
    assert lines["robot[0].state"] == range(3, 6)
    assert lines["robot[0].goal"] == range(6, 7)
    assert "elsewhere" not in lines
    assert lines_of("a: [1, 2", {"a"}) == {}


def test_failed_lines_are_marked() -> None:
    text = report_of(trial("one", False, path="robot.shape"))
    assert '<span class="marked">  shape: {name: circle, radius: 0.3}</span>' in text
    assert "scenario.yaml line 4" in text


def test_requirements_that_were_not_reached_are_one_line() -> None:
    one = trial("one", False, stage="schema")
    rest = [Outcome(assertion=name, stage="facts", passed=False, expected="it", observed=NOT_REACHED) for name in "abc"]
    one.verdict.outcomes += rest
    assert "Not reached: a, b, c" in Elements(report_of(one)).words


def test_marks_at_one_place_have_one_label() -> None:
    marks = [(k, Mark(points=[[x, 1]], text=text)) for k, x, text in ((1, 1, "a"), (2, 1, "b"), (1, 6, "a"))]
    text = marked_picture("p", Drawn(b"", (0, 8, 0, 8), (400, 400), 0.0, 0), marks, "At the start")
    assert re.findall(r"<text class=.marktext.*?>(.*?)</text>", text) == ["1, 2 a +1", "1"]


def test_long_texts_are_cut_with_a_sentence() -> None:
    text = "x\n" * 5000
    assert code(text).count("<span>") == 400
    assert "4601 more lines are in results.json" in code(text)
    assert len(prose("y" * 10**6)) < 1000
    assert "is not compared" in difference(text, text + "z")


def test_differences_show_what_changed() -> None:
    changes = difference("a: 1\nb: <2>\n", "a: 1\nb: <3>\n")
    assert '<span class="removed">-b: &lt;2&gt;</span>' in changes
    assert '<span class="added">+b: &lt;3&gt;</span>' in changes
    assert "the one that was given" in difference("a", "a")


def test_worlds_are_drawn_once_with_the_places_that_failed() -> None:
    marks = [Mark(points=[[6, 4]], text="<b>goal</b>"), Mark(points=[[99, 99]]), Mark(points=[[float("nan"), 0]])]
    text = report_of(trial("one", False, marks=marks), trial("one", True, "rules"), pictures=True)
    pictures = json.loads(re.search(r'id="pictures">(.*?)</script>', text)[1])  # type: ignore[index]
    assert len(pictures) == 2
    assert text.count("<image ") == 4
    assert "1 &lt;b&gt;goal&lt;/b&gt;</text>" in text
    assert "2 marks lie outside of the picture." in text


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("world: {width: 8}\nrobot: {kinematics: {name: nonsense}}\n", "cannot read the scenario"),
        ("world: [", "cannot read the scenario"),
        ("robot: {number: 62, distribution: {name: random}, shape: {name: circle, radius: 0.5}}\n", "cannot be built"),
    ],
)
def test_what_cannot_be_drawn_is_a_sentence(text: str, sentence: str) -> None:
    result = draw_answer(Job("scenario.yaml", text, 0, 0, 1.0))
    assert isinstance(result, str)
    assert sentence in result


def test_hostile_scenarios_do_not_stop_a_report() -> None:
    crowd = "world: {width: 9, height: 9}\nrobot: {number: 1000000, distribution: {name: random}}\n"
    trials = [trial("one", True), trial("two", False, files={"scenario.yaml": crowd}), trial("three", True, files={})]
    gallery = draw_trials(trials, [None] * 3)
    assert len(gallery.shown[0]) == 2
    assert isinstance(gallery.shown[1], str)
    assert gallery.shown[2] == "There is no scenario to draw."


@pytest.mark.parametrize(
    "text", ["\n" * 300_000, "```" * 300_000, "```\n" * 300_000, " " * 300_000, "robot\n" * 100_000]
)
def test_long_texts_are_searched_in_a_moment(text: str) -> None:
    begin = time.perf_counter()
    scenario = find_scenario(Answer("", {"scenario.yaml": text}, text), {})
    assert time.perf_counter() - begin < 2
    assert scenario is None


def test_real_answers_are_shown_with_what_was_given() -> None:
    instance = case_of("pub-19")
    gold = golds_of(instance)[0]
    trials = [
        trial_of(instance, grade(instance, gold), "gold"),
        trial_of(instance, grade(instance, Answer("", dict(instance.case.files))), "idle"),
    ]
    results = results_of(trials)
    assert [one and one.case.id for one in asked_of(results)] == ["pub-19", "pub-19"]
    text = page(content_of(results, pictures=False))
    assert "Changes of the given scenario.yaml" in text
    assert "The file is the one that was given." in text
    assert "graded with other cases" not in text
    results.cases = "older"
    assert "graded with other cases" in page(content_of(results, pictures=False))


def test_names_are_text_in_every_file(tmp_path: Path) -> None:
    hostile = f"{HOSTILE} $x$ =1+1"
    folder = written(tmp_path, trial("one", False).model_copy(update={"title": hostile, "arm": hostile}))
    for file in (tmp_path / "r.json", *folder.glob("*.*")):
        text = file.read_text(encoding="utf-8")
        assert escape_marks(text) == text, file.name
        assert "\x1b" not in text, file.name
    assert hostile in json.dumps(json.loads((folder / "results.json").read_text()), ensure_ascii=False).replace(
        "\\u001b", "\x1b"
    )
    shown = (folder / "report.md").read_text()
    assert "<script" not in shown
    assert not re.search(r"(?<!\\)\$", shown)
