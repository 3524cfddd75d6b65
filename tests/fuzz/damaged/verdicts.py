"""Files of evals: recordings of models, results of the grader, and the JSON of a proof."""

from __future__ import annotations

import json
import random
from collections.abc import Mapping
from pathlib import Path

from irsim_evals.cases.store import case_of
from irsim_evals.harness.recording import (
    Attempt,
    Call,
    Header,
    Recording,
    Turn,
    find_recording,
    grade_recording,
    task_hash,
    write_recording,
)
from irsim_evals.report.content import content_of
from irsim_evals.report.load import load_proof, load_results, merge
from irsim_evals.report.markdown import markdown
from irsim_evals.report.page import page
from irsim_evals.results import Results, cases_hash
from tests.evals.conftest import file_of, trial
from tests.fuzz.damaged.kind import Kind, made, text

__all__ = ["VERDICTS"]

_PROOF = {
    "rows": [{"kind": "gold", "operator": "none", "trials": 9, "wrong": 1}],
    "wrong": [{"case": "pub-01", "seed": 4}],
    "left_out": {"pub-02": 3},
    "seconds": 2.5,
}


def _write_recording(file: Path) -> None:
    """Two attempts that an error ended, so that nothing is graded, which would need a process."""
    known = {"case": "pub-01", "instance": "4", "arm": "skill", "task": task_hash(case_of("pub-01", 4))}
    call = Call(id="1", name="validate_scenario", args={"scenario_path": "a.yaml"}, result_sha="ab", result="fine")
    turns = [Turn(role="user", text="Make it."), Turn(role="assistant", calls=[call], usage={"input": 12})]
    attempts = [Attempt(**known, trial=k, messages=turns, ended="status 529", failed=True) for k in (1, 2)]
    header = Header(arm="skill", model="anthropic/x", date="2026-01-01", sdk={"inspect_ai": "0.3"})
    write_recording(Recording(header=header, attempts=attempts), file)


def _grade(file: Path, draw: random.Random) -> None:
    recording = find_recording(file, "skill")
    recording.attempts = [one for one in recording.attempts if one.failed]  # a process grades the others
    grade_recording(recording, [case_of("pub-01", 4)])


def _write_results(file: Path) -> None:
    trials = [trial("pub-01", True), trial("pub-02", False, path="robot.shape.radius")]
    trials[0].verdict.instance = "4"
    file_of(file, *trials, cases=cases_hash())


def _report(file: Path, draw: random.Random) -> None:
    """Write the report without its pictures, each of which a process draws."""
    content = content_of(merge([(file, load_results(file))]), pictures=False)
    page(content)
    markdown(content)


def _report_proof(file: Path, draw: random.Random) -> None:
    content = content_of(Results(cases="abc", trials=[trial("pub-01", True)]), proof=load_proof(file), pictures=False)
    page(content)
    markdown(content)


VERDICTS: Mapping[str, Kind] = {
    "recording": Kind(made(_write_recording, "log.jsonl"), _grade),
    "results": Kind(made(_write_results, "results.json"), _report, share=4),
    "proof": Kind(text("proof.json", json.dumps(_PROOF)), _report_proof, share=4),
}
