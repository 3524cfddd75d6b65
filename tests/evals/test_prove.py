"""The proof of the grader, and its command."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from typing import Any

import pytest

from irsim_evals.cases.store import case_of
from irsim_evals.grader import grade as grade_module
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.limited import LimitError, run_limited
from irsim_evals.proof import prove as proof_module
from irsim_evals.proof.prove import prove, tried
from tests.evals.conftest import RIGHT, irsim_evals


def test_limits_count_processor_time() -> None:
    assert run_limited(time.sleep, (1.0,), 0.3, "nap") is None  # as on a machine that does something else meanwhile
    with pytest.raises(LimitError, match=r"the sum took more than 0\.3 s of processor time"):
        run_limited(sum, (range(10**10),), 0.3, "sum")


@pytest.fixture
def slow_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first mutant exceeds the time limit of grading; all other outcomes are made up."""

    def run(work: Any, jobs: Iterable[Any], *_: Any) -> Iterator[Any]:
        late = LimitError("the grading took more than 120 s of processor time")
        ended = False
        for trial, _second in jobs:
            if trial.kind == "mutant" and not ended:
                ended = True
                yield late
            else:
                yield tried(trial, False) if trial.kind == "gold" else None

    monkeypatch.setattr(proof_module, "run_all", run)


@pytest.mark.usefixtures("slow_mutant")
def test_a_trial_that_ran_out_of_time_is_neither_accepted_nor_rejected() -> None:
    proof = prove(["pub-01"])
    [(trial, why)] = proof.unjudged
    assert trial.kind == "mutant"
    assert "120 s of processor time" in why
    assert proof.wrong == []
    assert proof.rates["false accepts"] == (0, 0)
    assert proof.rates["false rejects"][0] == 0


@pytest.mark.usefixtures("slow_mutant")
def test_the_command_lists_trials_without_a_verdict_and_fails() -> None:
    done = irsim_evals("prove", "pub-01")
    assert done.exit_code == 1
    [line] = [line for line in done.output.splitlines() if line.startswith("NO VERDICT")]
    assert "mutant" in line
    assert line.endswith("the grading took more than 120 s of processor time")
    assert "accepted" not in line


def test_a_verdict_alone_ends_at_the_first_assertion_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_episode(*_: Any) -> Any:
        raise AssertionError("an episode")

    case = case_of("pub-01")
    right = Answer("right", {"scenario.yaml": RIGHT})
    assert grade(case, right, whole=False).strict
    with monkeypatch.context() as patch:
        patch.setattr(grade_module, "run_episode", no_episode)
        small = grade(case, Answer("small", {"scenario.yaml": RIGHT.replace("0.35", "0.2")}), whole=False)
    assert not small.strict
    assert [one.assertion for one in small.failed()] == ["robot"]
    late = grade(case, Answer("late", {"scenario.yaml": f"{RIGHT}  vel_max: [0.1, 0.1]\n"}), whole=False)
    assert not late.strict
    assert late.outcomes[-1].assertion == "arrives"
    assert {one.assertion for one in grade(case, right).outcomes} >= {one.assertion for one in late.outcomes}
