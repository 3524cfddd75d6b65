"""Recordings: what a model answered and what the tools said, one JSON line for each attempt, to replay and to grade.

The first line says which model was recorded, with which versions and limits. Recordings hold no keys and no paths of
the machine.
"""

from __future__ import annotations

import json
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

import irsim
from irsim.common.hashing import digest
from irsim.diagnostics.errors import ArgumentError, PickledWhole
from irsim_evals.cases.store import Instance, given_pictures
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import failed_verdict
from irsim_evals.grader.limited import grade_answer
from irsim_evals.grader.outcome import Cost, Record, Verdict, name_of
from irsim_evals.results import Trial, trial_of

__all__ = [
    "Attempt", "Call", "Header", "Names", "Recording", "RecordingEnds", "Turn", "find_recording",
    "grade_recording", "matched", "read_recording", "scrubbed", "task_hash", "with_texts", "write_recording",
]  # fmt: skip

_SECRET_NAMES = re.compile(r"KEY|TOKEN|SECRET|PASSWORD|CREDENTIAL", re.IGNORECASE)
_SECRETS = re.compile(r"\b(?:sk-[A-Za-z0-9_-]{8,}|Bearer\s+[A-Za-z0-9._~+/=-]{8,}|gh[pousr]_[A-Za-z0-9]{20,})")
_MIN_SECRET = 8
"""Length from which on the value of a variable is taken for a secret."""
_RUN = re.compile(r"\b[a-z0-9_-]+-[0-9a-f]{6}\b")
_NAMED = re.compile(r"\$run\d+\b")


class RecordingEnds(PickledWhole, RuntimeError):
    """A recording that is replayed has no further answer of the model.

    Attributes:
        failed: Whether an error had ended the attempt there.
    """

    def __init__(self, why: str, failed: bool) -> None:
        super().__init__(why)
        self.failed = failed


class Header(Record):
    """Model, versions and limits of a recording."""

    kind: Literal["header"] = "header"
    schema_version: int = 1
    arm: str
    model: str
    date: str
    """Day and time of the recording, UTC."""
    sdk: dict[str, str] = {}
    """Package → version: the harness and the library of the model's service."""
    skills: str = ""
    """Digest of the skills."""
    mcp_server_version: str = irsim.__version__
    cases: str = ""
    """Digest of all case files."""
    sampling: dict[str, Any] = {}
    """Limits, and parameters of the model that were set."""


class Call(Record):
    """One call of a tool."""

    id: str
    name: str
    args: dict[str, Any]
    result_sha: str = ""
    """Digest of the answer; empty if there was none."""
    result: str = ""
    """Beginning of the answer."""
    failed: bool = False


class Turn(Record):
    """One message."""

    role: Literal["system", "user", "assistant"]
    text: str = ""
    pictures: int = 0
    calls: list[Call] = []
    """Tools that the model called, with what they answered."""
    stop_reason: str = ""
    usage: dict[str, int | float] = {}
    """Tokens of this answer of the model."""


class Attempt(Record):
    """One attempt at one case."""

    kind: Literal["trial"] = "trial"
    case: str
    instance: str = ""
    trial: int = 1
    arm: str
    task: str
    """Digest of what the agent was given: prompt, later turns, files and pictures."""
    messages: list[Turn] = []
    files: dict[str, str] = {}
    """Files that the agent left: path → text."""
    replies: list[str] = []
    """Last message of the agent to each prompt."""
    ended: str = ""
    """Why the attempt ended before the agent was done."""
    failed: bool = False
    """Whether an error ended it, so that there is nothing to grade."""
    cost: Cost = Cost()

    @property
    def reply(self) -> str:
        """Last message of the agent."""
        return self.replies[-1] if self.replies else ""

    def trial_with(self, verdict: Verdict, instance: Instance, model: str) -> Trial:
        """The trial with a verdict on what the attempt left."""
        verdict.cost = self.cost
        about = {"number": self.trial, "model": model, "reply": self.reply, "ended": self.ended}
        return trial_of(instance, verdict, self.arm, **about)


class Recording(Record):
    """A header and its attempts."""

    header: Header
    attempts: list[Attempt]

    def find(self, case: str, instance: str) -> list[Attempt]:
        """The attempts at an instance, in the order of their numbers."""
        attempts = [one for one in self.attempts if (one.case, one.instance) == (case, instance)]
        return sorted(attempts, key=lambda one: one.trial)


def task_hash(instance: Instance) -> str:
    """Digest of what an agent is given."""
    drawings = {name: drawing.model_dump(mode="json") for name, drawing in instance.case.drawings.items()}
    given = [instance.prompt, instance.case.turns, instance.case.files, drawings]
    return digest(json.dumps(given, ensure_ascii=False, sort_keys=True))[:16]


def write_recording(recording: Recording, path: Path) -> None:
    """Write a file of JSON lines."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [recording.header, *recording.attempts]
    path.write_text("".join(f"{line.model_dump_json()}\n" for line in lines), encoding="utf-8")


def read_recording(path: Path) -> Recording:
    """Read a file of JSON lines.

    Raises:
        ArgumentError: It cannot be read, or is not a recording.
    """
    fix = "give a .jsonl file that irsim-evals run has written"
    try:
        first, *rest = path.read_text(encoding="utf-8").splitlines()
        return Recording(
            header=Header.model_validate_json(first), attempts=[Attempt.model_validate_json(line) for line in rest]
        )
    except OSError as error:
        raise ArgumentError(f"{path} cannot be read: {error.strerror}", fix) from None
    except (ValueError, ValidationError) as error:
        why = str(error).splitlines()[0] if str(error) else "it is empty"
        raise ArgumentError(f"{path} is not a recording: {why}", fix) from None


def find_recording(path: Path, arm: str) -> Recording:
    """The recording of an arm: a file, or the newest one in a folder of logs; beside a log of inspect_ai lies its own.

    Raises:
        ArgumentError: There is no recording, or it is one of another arm.
    """
    if path.is_dir():
        paths = sorted(path.glob("*.jsonl"), key=lambda one: (one.stat().st_mtime, one.name), reverse=True)
        fitting = (recording for one in paths if (recording := read_recording(one)).header.arm == arm)
        newest = next(fitting, None)
        if newest is None:
            raise ArgumentError(f"{path} has no recording of the arm {arm}", "give the folder of its logs")
        return newest
    recording = read_recording(path.with_suffix(".jsonl") if path.suffix == ".eval" else path)
    if recording.header.arm != arm:
        raise ArgumentError(f"{path} records the arm {recording.header.arm}, not {arm}", "choose that arm")
    return recording


def grade_recording(recording: Recording, instances: Iterable[Instance]) -> list[Trial]:
    """Grade the recorded files of some instances with the grader of today, without tools and a model.

    Raises:
        ArgumentError: A case has changed, or an instance was not recorded.
    """
    return [
        _graded(attempt, instance, recording.header.model)
        for instance, attempts in matched(recording, instances)
        for attempt in attempts
    ]


def matched(recording: Recording, instances: Iterable[Instance]) -> Iterator[tuple[Instance, list[Attempt]]]:
    """Instances with the recorded attempts at them.

    Raises:
        ArgumentError: An instance was not recorded, or prompt or files of the case were changed after the recording.
    """
    for instance in instances:
        name, attempts = name_of(instance.case.id, instance.name), recording.find(instance.case.id, instance.name)
        if not attempts:
            raise ArgumentError(f"the recording has no attempt at {name}", "choose cases that it has")
        if any(attempt.task != task_hash(instance) for attempt in attempts):
            raise ArgumentError(
                f"the prompt or the files of {name} have changed since the recording was made", "record it again"
            )
        yield instance, attempts


def _graded(attempt: Attempt, instance: Instance, model: str) -> Trial:
    answer = Answer("recorded", attempt.files, attempt.reply, tuple(attempt.replies), given_pictures(instance))
    if attempt.failed:
        return attempt.trial_with(failed_verdict(instance, answer, "finished", "parse", attempt.ended), instance, model)
    return attempt.trial_with(grade_answer(instance, answer), instance, model)


def scrubbed(value: Any, folders: Iterable[Path | str] = ()) -> Any:
    """A text, or lists and mappings of texts, without secrets and absolute paths; ``folders`` become ``<folder>``."""
    replaced = _replacements(folders)

    def clean(text: str) -> str:
        for old, new in replaced:
            text = text.replace(old, new)
        return _SECRETS.sub("<secret>", text)

    return with_texts(value, clean)


def _replacements(folders: Iterable[Path | str]) -> list[tuple[str, str]]:
    """Texts and what stands for them, the longest first."""
    replacements = {str(path): "<folder>" for folder in folders for path in (Path(folder), Path(folder).resolve())}
    places = {"<packages>": Path(__file__).resolve().parents[2], "<python>": Path(sys.prefix), "<home>": Path.home()}
    for name, place in (*places.items(), ("<temporary>", Path(tempfile.gettempdir()))):
        for path in (place, place.resolve()):
            if len(path.parts) > 1:
                replacements.setdefault(str(path), name)
    for name, text in os.environ.items():
        if _SECRET_NAMES.search(name) and len(text) >= _MIN_SECRET and not text.startswith("/"):
            replacements[text] = "<secret>"
    return sorted(replacements.items(), key=lambda pair: -len(pair[0]))


class Names:
    """Numbers the ids of runs in the order in which they occur: the same work has the same text in every replay."""

    def __init__(self) -> None:
        self.ids: list[str] = []

    def numbered(self, value: Any) -> Any:
        """A value in which each id is ``$run1``, ``$run2`` …; ids that are new get the next number."""
        return with_texts(value, lambda text: _RUN.sub(lambda run: f"$run{self._number(run[0])}", text))

    def known(self, value: Any) -> Any:
        """The same, for what an agent writes: ids that no tool has named stay."""

        def known(run: re.Match[str]) -> str:
            return f"$run{self._number(run[0])}" if run[0] in self.ids else run[0]

        return with_texts(value, lambda text: _RUN.sub(known, text))

    def filled(self, value: Any) -> Any:
        """A value in which ids stand again where their numbers are."""
        ids = {f"$run{number}": name for number, name in enumerate(self.ids, 1)}
        return with_texts(value, lambda text: _NAMED.sub(lambda name: ids.get(name[0], name[0]), text))

    def _number(self, run_id: str) -> int:
        if run_id not in self.ids:
            self.ids.append(run_id)
        return self.ids.index(run_id) + 1


def with_texts(value: Any, change: Callable[[str], str]) -> Any:
    """A text, or lists and mappings of texts, with each text changed."""
    if isinstance(value, str):
        return change(value)
    if isinstance(value, dict):
        return {with_texts(key, change): with_texts(one, change) for key, one in value.items()}
    return [with_texts(one, change) for one in value] if isinstance(value, (list, tuple)) else value
