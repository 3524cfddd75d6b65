"""The tasks of the skills are cases of the grader; recorded calls of agents, and questions, lead to their answers."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcp import Client
from mcp.types import TextContent

from irsim_evals.cases.store import case_files, case_ids, case_of, folder, raw_case
from irsim_evals.cli.cases import write_case
from irsim_evals.grader.artefact import Answer, from_folder
from irsim_evals.grader.grade import grade
from irsim_evals.grader.outcome import NOT_REACHED
from irsim_mcp.server import build_server
from tests.evals.conftest import EVALS, ROOT, SKILLS, failures, irsim_evals
from tests.evals.texts import replay_transcript
from tests.warm import warm

ANSWERS: dict[str, dict[str, dict[str, Any]]] = yaml.safe_load(
    (Path(__file__).parent / "answers.yaml").read_text(encoding="utf-8")
)
TASKS = {skill: sorted(path.stem for path in folder("cases").glob(f"skills/{skill}/*.yaml")) for skill in SKILLS}
"""Skill → ids of its tasks."""
pytestmark = pytest.mark.anyio
each = pytest.mark.parametrize("skill", SKILLS)
each_task = pytest.mark.parametrize("task", [task for tasks in TASKS.values() for task in tasks])


def triggers(skill: str) -> list[dict[str, Any]]:
    told = json.loads((EVALS / "skills" / skill / "triggers.json").read_text(encoding="utf-8"))
    assert told["skill_name"] == skill
    queries: list[dict[str, Any]] = told["queries"]
    return queries


@each
def test_a_skill_has_tasks_that_are_no_examples_of_it(skill: str) -> None:
    assert len(TASKS[skill]) >= 5
    for task in TASKS[skill]:
        case = case_of(task).case
        assert (case.id, case.category) == (task, [skill])
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", task)
        assert case.check
        assert not set(case.files) & {path.name for path in ROOT.glob("skills/*/examples/*")}


def test_tasks_are_cases_that_only_count_if_they_are_named() -> None:
    tasks = [task for tasks in TASKS.values() for task in tasks]
    assert not set(tasks) & set(case_ids())
    assert sorted([*tasks, *case_ids(sets=True)]) == list(case_files())
    assert len(list(folder("cases").rglob("*.yaml"))) == len(case_files())
    assert "library-aisle" not in irsim_evals("cases").output
    assert "library-aisle" in irsim_evals("cases", "irsim-scenario").output


@each_task
def test_an_empty_folder_and_a_shrug_do_not_pass(task: str) -> None:
    instance = case_of(task)
    for reply in ("", "Done."):
        assert not grade(instance, Answer("nothing", instance.case.files, reply, (reply,))).strict


def test_there_is_an_answer_to_each_but_one() -> None:
    known = {(skill, name) for skill, answers in ANSWERS.items() for name in answers}
    asked = {(skill, task) for skill, tasks in TASKS.items() for task in tasks}
    assert asked - known == {
        ("irsim-dev", "ellipse"),  # a change of the whole tree
        ("irsim-scenario", "larger-world"),  # its answer is a transcript, as is the next one's
        ("irsim-benchmark", "three-densities"),
    }
    assert known <= asked


def runs_programs(skill: str, task: str) -> bool:
    return "run" in ANSWERS[skill][task] or any("command" in item for item in raw_case(task)["assert"])


def written(skill: str, task: str, where: Path) -> None:
    """Write the known answer to a task into a new folder, as an agent would leave it."""
    answer = ANSWERS[skill][task]
    write_case(where, case_of(task))
    for path, text in answer.get("files", {}).items():
        (where / path).write_text(text, encoding="utf-8")
    for old, new in answer.get("replace", {}).items():
        text = (where / answer["given"]).read_text(encoding="utf-8")
        assert old in text
        (where / answer["given"]).write_text(text.replace(old, new), encoding="utf-8")
    for line in answer.get("run", []):
        command, _, target = line.partition(" > ")
        words = shlex.split(command)
        module = words[1:] if words[0] == "python" else ["-m", *words]
        started = warm([sys.executable, *module])
        done = subprocess.run(started, cwd=where, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        if target:
            (where / target).write_text(done.stdout, encoding="utf-8")
    if "reply" in answer:
        (where / "reply.md").write_text(answer["reply"], encoding="utf-8")


@pytest.mark.parametrize(
    ("skill", "task"),
    [
        pytest.param(skill, task, id=task, marks=[pytest.mark.slow] if runs_programs(skill, task) else [])
        for skill, answers in ANSWERS.items()
        for task in answers
    ],
)
def test_a_task_can_be_solved(skill: str, task: str, tmp_path: Path) -> None:
    written(skill, task, tmp_path / task)
    answer = replace(from_folder(tmp_path / task), trusted_folder=tmp_path / task)
    verdict = grade(case_of(task), answer)
    assert failures(verdict) == []
    assert verdict.strict


@pytest.mark.parametrize(
    ("change", "failed"),
    [
        (("range_max: 4", "range_max: 5"), {"edit", "scanner"}),
        (("radius: 0.35", "radius: 0.3"), {"edit"}),
        (("   (keep this line)", ""), set()),
        (("# forward", ""), {"edit"}),
        (("vel_max: ", "velmax: "), {"valid", "edit", "scanner", "arrives", "no-collision"}),
        (("[7, 7, 0]", "[7, 4.5, 0]"), {"edit", "arrives", "no-collision"}),
    ],
)
def test_a_wrong_edit_is_seen(change: tuple[str, str], failed: set[str]) -> None:
    instance = case_of("shorter-sight")
    right = (
        instance.case.files["lobby.yaml"].replace("range_max: 6", "range_max: 4").replace("number: 121", "number: 61")
    )
    assert change[0] in right
    verdict = grade(instance, Answer("edit", {"lobby.yaml": right.replace(*change)}))
    assert {one.assertion for one in verdict.failed()} == failed


@pytest.mark.parametrize(
    ("task", "old", "new", "failed"),
    [
        ("library-aisle", "[[1.05, 5.5, 0], [2.95, 5.5, 0]]", "[[1.04, 5.5, 0], [2.96, 5.5, 0]]", set()),
        ("library-aisle", "[[1.05, 5.5, 0], [2.95, 5.5, 0]]", "[[0.8, 5.5, 0], [2.95, 5.5, 0]]", {"aisle"}),
        ("library-aisle", "length: 0.4, width: 10", "length: 0.6, width: 10", {"depth", "aisle"}),
        ("library-aisle", "length: 0.4, width: 10", "length: 0.4, width: 7", {"depth", "aisle"}),
        ("library-aisle", "vel_max: [1.0, 1.5]", "vel_max: [3.6, 1.5]", {"robot"}),
        ("library-aisle", "[2, 0.8, 1.5708]", "[2, 0.8, 90]", {"robot"}),
        ("library-aisle", "[2, 10.2]", "[2, 5]", {"aisle"}),
        ("library-aisle", "name: diff", "name: omni", {"robot"}),
        ("shuttle-fleet", "number: 12", "number: 11", {"robots"}),
        ("shuttle-fleet", "width: 11, height: 7", "width: 7, height: 11", {"hall", "inside-world"}),
        ("shuttle-fleet", ", boundary: walls", "", {"hall"}),
        ("shuttle-fleet", "vel_max: [0.8, 0.8]", "vel_max: [0.8, 1.2]", {"shuttles"}),
        ("shuttle-fleet", "name: orca, timeHorizon: 3, timeHorizonObst: 1", "name: dash", {"shuttles", "no-collision"}),
        ("shuttle-fleet", "radius: 0.2", "radius: 20", {"valid"}),
        ("night-watch", "loop: true", "loop: false", {"robot", "to-and-fro"}),
        ("night-watch", "goal: [9, 3]", "goal: [8, 3]", {"to-and-fro"}),
        ("night-watch", "time_limit: 120", "time_limit: 2", {"world"}),
        ("night-watch", "[0.5, 0.5]", "[0.5, 0.9]", {"limit"}),
        ("saeulenhalle", "[1.5, 2, 0.507]", "[1, 5, 2]", {"robot"}),
        ("saeulenhalle", "length: 0.8, width: 0.8", "length: 0.8, width: 0.4", {"squares"}),
        ("saeulenhalle", "[6, 7.5, 0]", "[6, 4.5, 0]", {"arrives", "no-collision"}),
        ("saeulenhalle", "radius: 0.3", "radius: 0.6", {"robot"}),
    ],
)
def test_a_wrong_answer_is_seen(task: str, old: str, new: str, failed: set[str]) -> None:
    [(name, right)] = ANSWERS["irsim-scenario"][task]["files"].items()
    assert old in right
    verdict = grade(case_of(task), Answer("wrong", {name: right.replace(old, new)}))
    assert failed <= {one.assertion for one in verdict.failed() if one.observed != NOT_REACHED}, failures(verdict)
    assert verdict.strict == (not failed)


def test_an_answer_of_several_scenarios_is_graded_one_by_one() -> None:
    text = "world: {width: 20, height: 20}\nrobot: [{goal: [9, 9], behavior: {name: orca}, kinematics: {name: diff}}]\n"
    place = "distribution: {name: random, range_low: [2, 11, 0], range_high: [18, 18, 0]}"
    crowd = f"obstacle: [{{number: %d, shape: {{name: circle, radius: 0.2}}, {place}}}]\n"
    files = {f"crowd-{n}.yaml": text + crowd % n for n in (5, 25)}
    files["crowd-15.yaml"] = text.replace("kinematics", "cinematics") + crowd % 15
    result = {"behaviors": ["orca", "dash"], "rows": [{"success": {"n": 10}}, {"success": {"n": 9}}]}
    files["result.json"] = json.dumps(result)
    verdict = grade(case_of("three-crowds"), Answer("crowds", files, "orca 90 % [60, 98]"))
    seen = {one.assertion: (one.passed, one.observed) for one in verdict.outcomes}
    assert not seen["valid"][0]
    del files["crowd-15.yaml"]
    files["crowd-30.yaml"] = text + "obstacle: 7\n"
    verdict = grade(case_of("three-crowds"), Answer("crowds", files, "crowd-5.yaml: orca 90 % [60, 98]"))
    seen = {one.assertion: (one.passed, one.observed) for one in verdict.outcomes}
    assert seen["five"] == (True, "obstacles: 5")
    assert seen["twenty-five"] == (True, "obstacles: 25")
    assert seen["fifteen"] == (False, "there is no file crowd-15.yaml")
    assert seen["behaviors"] == (True, "1: result.json")
    assert seen["seeds"] == (False, "1: result.json; result.json has at rows[*].success.n: 10, 9")


def test_programs_run_only_where_that_is_allowed(tmp_path: Path) -> None:
    where = tmp_path / "compass"
    written("irsim-dev", "compass", where)
    marker = where / "was-run"
    (where / "compass.py").write_text(
        (where / "compass.py").read_text(encoding="utf-8") + f"\nopen({str(marker)!r}, 'w').close()\n", encoding="utf-8"
    )
    done = irsim_evals("grade", where)
    assert done.exit_code == 1
    assert 'loads: expected `python -c "import compass"` succeeds; observed it was not run' in done.output
    assert not marker.exists()
    assert irsim_evals("grade", where, "--run-programs").exit_code == 0
    assert marker.exists()
    (where / "compass.py").write_text("SENSORS.register\nraise SystemExit('no compass')\n", encoding="utf-8")
    done = irsim_evals("grade", where, "--run-programs")
    assert done.exit_code == 1
    assert "no compass" in done.output or "NameError" in done.output


@each
def test_triggers_are_balanced(skill: str) -> None:
    queries = triggers(skill)
    assert len({item["query"] for item in queries}) == len(queries) == 20
    assert all(set(item) == {"query", "should_trigger", "split"} for item in queries)
    assert 8 <= sum(not item["should_trigger"] for item in queries) <= 10
    split = Counter(item["split"] for item in queries)
    assert split == {"train": 12, "validation": 8}
    for part in split:
        wanted = [item["should_trigger"] for item in queries if item["split"] == part]
        assert 0.4 <= sum(wanted) / len(wanted) <= 0.7, part


def test_a_query_leads_to_one_skill_at_most() -> None:
    wanted = Counter(item["query"] for skill in SKILLS for item in triggers(skill) if item["should_trigger"])
    assert max(wanted.values()) == 1


TRANSCRIPTS = sorted((EVALS / "transcripts").glob("*.jsonl"))
QUESTIONS: list[dict[str, Any]] = json.loads((EVALS / "questions.json").read_text(encoding="utf-8"))


class Caller:
    """Calls tools; `$run2` in arguments is the second run that they made."""

    def __init__(self, client: Client) -> None:
        self.client = client
        self.runs: list[str] = []

    async def __call__(self, tool: str, arguments: dict[str, Any]) -> tuple[str, bool]:
        known = {f"$run{i}": run for i, run in enumerate(self.runs, 1)}
        filled = {key: known.get(value, value) if isinstance(value, str) else value for key, value in arguments.items()}
        result = await self.client.call_tool(tool, filled)
        first = result.content[0]
        assert isinstance(first, TextContent)
        if tool == "run_episode" and not result.is_error:
            assert result.structured_content is not None
            self.runs.append(result.structured_content["run_id"])
        return first.text, bool(result.is_error)


def lines(path: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The case and the files that make up the answer, and what was done."""
    first, *rest = (json.loads(line) for line in path.read_text(encoding="utf-8").splitlines())
    return first, rest


@pytest.mark.slow(8)
@pytest.mark.parametrize("path", TRANSCRIPTS, ids=lambda path: path.stem)
async def test_a_transcript_still_leads_to_its_end(path: Path, tmp_path: Path) -> None:
    async with Client(build_server(tmp_path)) as client:
        done = await replay_transcript(path, client, tmp_path)
    assert done.drift == []
    left = {name: (tmp_path / name).read_text(encoding="utf-8") for name in lines(path)[0]["answer"]}
    assert left == answer_of(path)


def answer_of(path: Path) -> dict[str, str]:
    """Name → last text of each file of the answer."""
    asked, steps = lines(path)
    last = {step["file"]: step["text"] for step in steps if "file" in step}
    return {name: last[name] for name in asked["answer"]}


@pytest.mark.parametrize("path", TRANSCRIPTS, ids=lambda path: path.stem)
def test_the_answer_of_a_transcript_passes_its_case(path: Path) -> None:
    verdict = grade(case_of(lines(path)[0]["case"]), Answer(path.stem, answer_of(path)))
    assert failures(verdict) == []
    assert verdict.strict


def test_transcripts_are_varied_and_well_formed() -> None:
    assert len(TRANSCRIPTS) >= 6
    tools: set[str] = set()
    for path in TRANSCRIPTS:
        asked, steps = lines(path)
        assert set(asked) == {"case", "answer"}
        assert asked["case"] in case_files()
        assert all(set(step) in ({"file", "text"}, {"tool", "arguments", "expect"}) for step in steps)
        assert all(step["expect"] for step in steps if "tool" in step)
        tools |= {step["tool"] for step in steps if "tool" in step}
    assert tools == {"lookup", "validate_scenario", "render_snapshot", "run_episode", "inspect_run", "benchmark"}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("questions")


@pytest.mark.parametrize("item", QUESTIONS, ids=lambda item: item["id"])
async def test_the_tools_know_the_answer(item: dict[str, Any], shared: Path) -> None:
    assert set(item) == {"id", "question", "answer", "calls", "found"}
    async with Client(build_server(shared)) as client:
        call = Caller(client)
        for step in item["calls"]:
            text, _ = await call(step["tool"], step["arguments"])
    match = re.search(item["found"], text)
    assert match, text
    assert ", ".join(match.groups()) == item["answer"]


def test_there_are_ten_questions() -> None:
    assert len({item["id"] for item in QUESTIONS}) == len(QUESTIONS) == 10
