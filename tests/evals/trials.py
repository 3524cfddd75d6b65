"""Trials with made-up verdicts, for tests of reports and comparisons."""

from __future__ import annotations

from pathlib import Path

from irsim_evals.grader.outcome import STAGES, Cost, Mark, Outcome, Stage, Verdict
from irsim_evals.results import Results, Trial, write_results

SCENARIO = """\
world: {width: 8, height: 6}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.3}
  state: [1, 1, 0]
  goal: [6, 4, 0]
  behavior: {name: dash}
"""


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
