"""Where the evals are, and short ways to the command, to cases and trials, and to what a predicate sees."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.cases.store import Instance, instance_of
from irsim_evals.cli import app
from irsim_evals.grader import programs
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.episode import GradedEpisode, at_start, run_episode, without_noise
from irsim_evals.grader.grade import grade
from irsim_evals.grader.limited import preload
from irsim_evals.grader.material import Material
from irsim_evals.grader.outcome import STAGES, Cost, Mark, Outcome, Stage, Verdict
from irsim_evals.grader.predicates._base import Observation, registered
from irsim_evals.grader.selection import Selector
from irsim_evals.results import Results, Trial, write_results
from tests.warm import warm

preload("pytest")  # which limited processes import where it is the program that starts them
ROOT = Path(__file__).resolve().parents[2]
EVALS = ROOT / "evals"
SKILLS = sorted(path.parent.name for path in (ROOT / "skills").glob("*/SKILL.md"))
RIGHT = """
world: {width: 14, height: 9}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.35}
  state: [2, 1.5, 1.5708]
  goal: [12, 7.5, 0]
  behavior: {name: dash}
"""
"""A right answer to ``pub-01``."""
SCENARIO = """\
world: {width: 8, height: 6}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.3}
  state: [1, 1, 0]
  goal: [6, 4, 0]
  behavior: {name: dash}
"""


def irsim_evals(*words: object) -> Result:
    """Run the command in this process."""
    return CliRunner().invoke(app, [str(word) for word in words])


def refusal(*words: object) -> str:
    """Why the command refuses to do something, on one line."""
    done = irsim_evals(*words)
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.output
    return " ".join(done.output.split())


def graded(instance: Instance, text: str, reply: str = "") -> Verdict:
    """The verdict on an answer that is one scenario."""
    return grade(instance, Answer("answer", {"scenario.yaml": text}, reply))


def failures(verdict: Verdict) -> list[tuple[str, str, str]]:
    """Assertions that do not hold, with the expected and the observed value."""
    return [(one.assertion, one.expected, one.observed) for one in verdict.failed()]


def failed(verdict: Verdict) -> list[str]:
    """Names of the assertions that do not hold."""
    return [one.assertion for one in verdict.failed()]


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def warm_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Programs of answers that end by themselves run in processes that have loaded irsim already."""
    monkeypatch.setattr(
        programs, "_command", lambda *words: warm([sys.executable, "-m", "irsim_evals.grader.run_program", *words])
    )


def made_up(*assertions: dict[str, Any], **keys: Any) -> Instance:
    """A case with some assertions about the start, and further keys."""
    raw = {"id": "made-up", "title": "x", "category": ["basic"], "level": 1, "prompt": "x", "assert": [*assertions]}
    return instance_of(raw | keys)


def world(text: str, reply: str = "", **selectors: dict[str, Any]) -> Material:
    """An answer that is one scenario."""
    scenario = read(load_text(text)).scenario
    chosen = {name: Selector.model_validate(value) for name, value in selectors.items()}
    return Material(Answer("x", {"scenario.yaml": text}, reply), scenario, chosen)


def episode(material: Material, seconds: float) -> GradedEpisode:
    assert material.scenario is not None
    return run_episode(material.scenario, 0, seconds)


def seen(material: Material, name: str, keys: dict[str, Any], seconds: float = 0.0) -> Observation:
    """Observation of a predicate about an answer; predicates about episodes get one of that length."""
    predicate: Any = registered()[name].model_validate(keys)

    def run() -> GradedEpisode:
        if not seconds:
            return at_start(material.scene(0))
        assert material.scenario is not None
        scenario = without_noise(material.scenario) if predicate.exact else material.scenario
        return run_episode(scenario, 0, seconds, looks=predicate.looks)

    subject = {"scene": lambda: (material.scene(0),), "episode": lambda: (run(),)}
    try:
        observation: Observation = predicate.observe(material, *subject.get(predicate.subject, tuple)())
    except LookupError as error:  # which the grader takes for something that does not hold
        return Observation(False, "something that can be observed", str(error))
    return observation


def trial(
    case: str,
    passed: bool,
    arm: str = "skill",
    *,
    number: int = 1,
    family: str = "",
    stage: Stage = "facts",
    reply: str = "",
    files: dict[str, str] | None = None,
    marks: list[Mark] | None = None,
    path: str | None = None,
    cost: Cost | None = None,
    category: str = "basic",
) -> Trial:
    """An answer that fails one requirement of a stage, or meets all."""
    outcomes = [
        Outcome(assertion=f"{name}-holds", stage=name, passed=True, expected="it", observed="it")
        for name in STAGES[: STAGES.index(stage)]
    ]
    outcomes.append(Outcome(assertion="loads", stage="load", passed=True, expected="a world", observed="3 steps"))
    outcomes.append(
        Outcome(
            assertion="size", stage=stage, passed=passed, expected="radius 0.2", observed="radius 0.3", yaml_path=path,
            marks=marks or [],
        )
    )  # fmt: skip
    share = sum(one.passed for one in outcomes) / len(outcomes)
    verdict = Verdict(
        case=case, strict=passed, rate=share, reached=STAGES[-1] if passed else stage, outcomes=outcomes,
        files={"scenario.yaml": SCENARIO} if files is None else files, cost=cost or Cost(),
    )  # fmt: skip
    return Trial(
        arm=arm, number=number, title=f"Title of {case}", prompt=f"Prompt of {case}", category=[category], level=2,
        family=family or case, reply=reply, verdict=verdict,
    )  # fmt: skip


def file_of(path: Path, *trials: Trial, cases: str = "abc") -> Path:
    """A file of results."""
    write_results(Results(cases=cases, trials=list(trials)), path)
    return path
