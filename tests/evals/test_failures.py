"""Each answer that fails, or costs too much, has one main reason, by a fixed rule."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from irsim_evals.grader.artefact import cost_of
from irsim_evals.grader.outcome import Cost, Stage, Step
from irsim_evals.report.content import content_of
from irsim_evals.report.failures import MEANINGS, category_of
from irsim_evals.report.markdown import markdown
from irsim_evals.report.page import page
from irsim_evals.results import Results, Trial
from tests.evals.conftest import irsim_evals, trial

CLEAN, BROKEN = Step(tool="validate_scenario"), Step(tool="validate_scenario", codes=["unknown-key"])
VAIN = Step(tool="lookup", error=True, codes=["unknown-topic"])


def answer(passed: bool = False, stage: Stage = "facts", *steps: Step, ended: str = "", **more: Any) -> Trial:
    cost = Cost(calls=len(steps), steps=list(steps)) if steps else Cost(**more.pop("cost", {}))
    observed = more.pop("observed", None)
    one = trial("pub-01", passed, stage=stage, cost=cost, **more)
    if observed:
        one.verdict.outcomes[-1].observed = observed
    one.ended = ended
    return one


def nothing_left() -> Trial:
    one = answer(stage="parse")
    one.verdict.outcomes[-1].assertion = "answered"
    return one


EXAMPLES: list[tuple[str | None, Trial]] = [
    (None, answer(True, "facts", CLEAN)),
    ("efficiency", answer(True, "facts", *[CLEAN] * 11)),
    ("efficiency", answer(True, cost={"calls": 2, "tokens": 9_000})),
    (None, answer(True, cost={"calls": 2, "tokens": 90_000, "turns": 3})),  # all that the model read
    ("early stop", answer(False, "facts", CLEAN, ended="the limit of 9,000 tokens was reached")),
    ("early stop", nothing_left()),
    ("early stop", answer(False, "facts", Step(tool="write_file"))),
    ("early stop", answer(False, "reply", CLEAN)),
    ("recovery", answer(False, "schema", CLEAN, BROKEN)),
    ("recovery", answer(False, "load", CLEAN, Step(tool="irsim run", error=True))),
    ("discovery", answer(False, "facts", Step(tool="lookup"), VAIN, CLEAN)),
    ("discovery", answer(False, "schema", observed="robot.behaviour: 'behaviour' is not a key of 'robot'")),
    ("discovery", answer(False, "facts", BROKEN, CLEAN, path="robot[0].behavior")),
    ("syntax", answer(False, "schema", observed="world.width: -1 is less than 0")),
    ("syntax", answer(False, "parse", CLEAN)),
    ("parameters", answer(False, "facts", VAIN, Step(tool="lookup"), CLEAN, path="robot[0].shape.radius")),
    ("parameters", answer(False, "behavior")),
]


@pytest.mark.parametrize(("category", "one"), EXAMPLES, ids=[f"{name}-{k}" for k, (name, _) in enumerate(EXAMPLES)])
def test_each_answer_has_one_main_reason(category: str | None, one: Trial) -> None:
    assert category_of(one.verdict, one.ended) == category


def test_reports_and_the_command_count_the_reasons(tmp_path: Path) -> None:
    trials = [one.model_copy(update={"number": k}) for k, (_, one) in enumerate(EXAMPLES, 1)]
    content = content_of(Results(trials=trials), pictures=False)
    assert list(content.failures["skill"]) == list(MEANINGS)
    assert sum(content.failures["skill"].values()) == len([name for name, _ in EXAMPLES if name])
    assert "| recovery | 2 | the last check showed an error, and it was not mended |" in markdown(content)
    assert "(attempt 9), recovery: size: expected radius 0.2" in markdown(content)
    shown = page(content)
    assert "<h2>Kinds of failures</h2>" in shown
    assert "fails at schema · recovery" in shown
    assert irsim_evals("export", tmp_path / "work", "pub-01").exit_code == 0
    done = irsim_evals("grade", tmp_path / "work")
    assert done.output.endswith(
        "0 of 1 case passes\n  1 early stop: it ended without a file, without a check, or without saying what was "
        "asked\n"
    )


def test_calls_of_a_log_are_kept_with_the_errors_that_they_showed(tmp_path: Path) -> None:
    lines = [
        {"tool": "lookup", "error": True, "tokens": 5, "codes": ["unknown-topic"]},
        {"tool": "validate_scenario", "error": False, "tokens": 9},
    ]
    log = tmp_path / "calls.jsonl"
    log.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    assert cost_of(log).steps == [VAIN, CLEAN]
