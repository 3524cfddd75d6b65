"""Programs in an answer: they are executed, within limits, if they only run scenarios; their output is graded."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.limited import grade_answer
from irsim_evals.grader.outcome import Outcome, Verdict
from irsim_evals.grader.programs import problems_of, run_program
from tests.evals.conftest import failed, failures, made_up

SCENE = """
world: {width: 14, height: 9}
robot: {kinematics: {name: diff}, state: [2, 2, 0], goal: [12, 7, 0], behavior: {name: dash}}
"""

RUNNER = """
import json
from pathlib import Path

import irsim

result = irsim.benchmark("scenario.yaml", behaviors=["dash", "rvo"], seeds=4, steps=200)
env = irsim.make("scenario.yaml", seed=1)
for _ in range(10):
    env.step()
    if env.done():
        break
env.end()
Path("rates.json").write_text(json.dumps({"success": 1.0}))
print("success rate 1.0, collision rate 0.0")
"""


def case(python: str, **program: object) -> Instance:
    one = {"id": "one", "count": {"of": "robots", "number": 1}}
    return made_up({"id": "runs", "program": program} if program else one, python=python)


def verdict_on(program: str, instance: Instance) -> Verdict:
    return grade_answer(instance, Answer("answer", {"scenario.yaml": SCENE, "run.py": program}))


def outcome(verdict: Verdict, name: str) -> Outcome:
    [only] = [item for item in verdict.outcomes if item.assertion == name]
    return only


def test_a_runner_is_run_and_its_output_graded() -> None:
    right = verdict_on(RUNNER, case("runner", prints=["success rate", r"collision rate 0\.0"]))
    assert failures(right) == []
    wrong = verdict_on(RUNNER, case("runner", prints=["timeout rate"]))
    assert failed(wrong) == ["runs"]
    assert "success rate 1.0" in outcome(wrong, "runs").observed


def test_no_program_may_be_left_where_only_yaml_was_wanted() -> None:
    verdict = verdict_on("print('hello')\n", case("none"))
    assert not verdict.strict
    assert outcome(verdict, "only-yaml").observed == "run.py is a program"


@pytest.mark.parametrize(
    ("program", "why"),
    [
        ("import os\nos.system('date')", "line 1: it imports os"),
        ("import subprocess", "line 1: it imports subprocess"),
        (
            "from pathlib import Path\nimport pathlib\npathlib.os.system('date')",
            "line 3: a runner needs no other modules",
        ),
        ("eval('1')", "line 1: it uses eval"),
        ("().__class__.__mro__", "line 1: it uses __"),
        ("import irsim\nirsim.register_behavior(1)", "line 2: a runner registers no code"),
        ("import irsim\nenv = irsim.make('a.yaml')\nenv.robot.set_state([1, 2, 0])", "line 3: a runner does not place"),
        ("def f(:", "it is not Python"),
        ("from .other import x", "line 1: it imports a module beside it"),
    ],
)
def test_programs_that_do_more_than_run_scenarios_are_refused(program: str, why: str) -> None:
    problems = problems_of(program)
    assert any(item.startswith(why) for item in problems), problems


def test_an_endless_program_is_ended(tmp_path: Path) -> None:
    (tmp_path / "run.py").write_text("while True:\n    pass\n")
    begin = time.monotonic()
    printed = run_program(tmp_path, "run.py", seconds=0.5)
    assert time.monotonic() - begin < 20
    assert printed.why == "run.py did not end within 0.5 s"


@pytest.mark.parametrize(
    "program",
    [
        "open('/tmp/irsim-evals-was-here', 'w')",
        "import sys\nprint(1 / 0)",
        "import pathlib\npathlib.Path('../irsim-evals-was-here').write_text('x')",
        "import numpy as np\nnp.save('/tmp/irsim-evals-was-here.npy', 1)",
    ],
)
def test_a_program_that_writes_elsewhere_or_fails_does_not_pass(program: str, tmp_path: Path) -> None:
    folder = tmp_path / "answer"
    folder.mkdir()
    (folder / "run.py").write_text(program)
    printed = run_program(folder, "run.py")
    assert not printed.passed
    assert "exit code" in printed.why
    assert not list(Path("/tmp").glob("irsim-evals-was-here*"))
    assert not (tmp_path / "irsim-evals-was-here").exists()
