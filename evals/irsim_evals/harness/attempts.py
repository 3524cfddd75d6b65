"""From the log of inspect_ai to attempts and trials, and from a recorded attempt to a model that answers the same."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from inspect_ai.model import ChatCompletionChoice, ChatMessageAssistant, ModelOutput, ModelUsage, get_model
from inspect_ai.tool import ToolCall

from irsim.common.hashing import digest
from irsim.common.text import shorten_pair
from irsim.diagnostics.report import error_codes
from irsim_evals.cases.store import Instance
from irsim_evals.grader.grade import failed_verdict
from irsim_evals.grader.outcome import Cost, Step, Verdict
from irsim_evals.harness.recording import Attempt, Call, Names, RecordingEnds, Turn, scrubbed, task_hash, with_texts
from irsim_evals.harness.task import SCORER, Work
from irsim_evals.results import Trial, trial_of

__all__ = ["attempt_of", "drift_of", "replayed_model", "trial_from", "unfinished"]

_EXCERPT = 400
"""Characters of a tool's answer that a recording keeps."""
_LIMITS = {
    "token": "{:,.0f} tokens", "message": "{:,.0f} messages", "time": "{:g} s", "working": "{:g} s",
    "cost": "{:g} US dollars", "turn": "{:,.0f} turns",
}  # fmt: skip
_MESSAGE = re.compile(r"""['"]message['"]:\s*(?P<quote>['"])(?P<text>.+?)(?P=quote)\s*[,}]""")
_STATUS = re.compile(r"Error code\W+(\d{3})")
_MAX_DRIFT = 160
"""Characters of an answer that a report of drift shows."""


def attempt_of(sample: Any, arm: str, instance: Instance, work: Work | None) -> Attempt:
    """The attempt that a sample of a log records, with what else is known of it, without keys and paths."""
    folders = [work.folder, work.folder.parent] if work is not None else []
    ended, failed = _end_of(sample, work)
    verdict = _verdict_of(sample)
    made = {
        "messages": [turn.model_dump() for turn in _turns_of(sample, folders)],
        "files": verdict.files if verdict is not None else {},
        "replies": work.replies if work is not None else [],
        "ended": ended,
    }
    return Attempt(
        case=instance.case.id, instance=instance.name, trial=sample.epoch, arm=arm, task=task_hash(instance),
        failed=failed or verdict is None, cost=_cost_of(sample, work), **scrubbed(made, folders),
    )  # fmt: skip


def trial_from(attempt: Attempt, sample: Any, instance: Instance, model: str) -> Trial:
    """The trial of an attempt; one that an error ended is a failed verdict which says so."""
    verdict = None if attempt.failed else _verdict_of(sample)
    if verdict is None:
        verdict = failed_verdict(instance, None, "finished", "parse", attempt.ended or "the attempt has no result")
    return attempt.trial_with(verdict, instance, model)


def unfinished(instance: Instance, arm: str, number: int, model: str) -> Trial:
    """The trial of an attempt that was never made."""
    why = "the evaluation ended before this attempt"
    verdict = failed_verdict(instance, None, "finished", "parse", why)
    return trial_of(instance, verdict, arm, number=number, model=model, ended=why)


def _verdict_of(sample: Any) -> Verdict | None:
    score = (sample.scores or {}).get(SCORER)
    data = (score.metadata or {}).get("verdict") if score is not None else None
    return Verdict.model_validate(data) if data is not None else None


def _end_of(sample: Any, work: Work | None) -> tuple[str, bool]:
    """Why an attempt ended early, and whether because of an error."""
    if sample.error is not None:
        return _error_of(sample), True
    if sample.limit is not None:
        kind, limit = sample.limit.type, sample.limit.limit
        return f"the limit of {_LIMITS.get(kind, f'{kind} {{:g}}').format(limit)} was reached", False
    return (work.ended, work.failed) if work is not None else ("", False)


def _error_of(sample: Any) -> str:
    """The error that ended an attempt, in one line; an error of the model's service comes first."""
    asked = [event for event in sample.events if event.event == "model"]
    if not asked or not asked[-1].error:
        return f"the attempt failed: {_one_line(sample.error.message)}"
    tries = next((i for i, event in enumerate(reversed(asked)) if not event.error), len(asked))
    message = asked[-1].error
    said, status = _MESSAGE.search(message), _STATUS.search(message)
    parts = [f"status {status[1]}" if status else "", said["text"] if said else _one_line(message)]
    parts.append(f"tried {tries} times" if tries > 1 else "")
    return "the model's service failed: " + ", ".join(part for part in parts if part)


def _one_line(text: str) -> str:
    return " ".join(text.split())[:300]


def _turns_of(sample: Any, folders: Any) -> list[Turn]:
    outputs = {event.output.message.id: event.output for event in _answers(sample)}
    names, turns = Names(), []
    calls: dict[str, Call] = {}
    for message in sample.messages:
        if message.role == "tool":
            call = calls.get(message.tool_call_id or "")
            if call is not None:
                text = names.numbered(scrubbed(result_text(message), folders))
                call.result_sha, call.result = digest(text)[:16], text[:_EXCERPT]
                call.failed = message.error is not None
            continue
        turn = Turn(role=message.role, text=names.known(message.text), pictures=_pictures(message.content))
        output = outputs.get(message.id) if message.role == "assistant" else None
        if output is not None:
            turn.stop_reason = output.stop_reason
            turn.usage = _usage(output.usage)
        for one in getattr(message, "tool_calls", None) or []:
            calls[one.id] = Call(id=one.id, name=one.function, args=names.known(one.arguments))
            turn.calls.append(calls[one.id])
        turns.append(turn)
    return turns


def result_text(message: Any) -> str:
    """The answer of a tool as text; a picture is named and not compared, since it depends on fonts and libraries."""
    if message.error is not None:
        return f"error: {message.error.message}"
    pictures = _pictures(message.content)
    return str(message.text) + (f"\n[{pictures} pictures]" if pictures else "")


def _pictures(content: Any) -> int:
    return sum(part.type == "image" for part in content) if isinstance(content, list) else 0


def _answers(sample: Any) -> list[Any]:
    """The answers of the model that arrived."""
    return [event for event in sample.events if event.event == "model" and not event.error and event.output.choices]


def _usage(usage: Any) -> dict[str, int | float]:
    known: Mapping[str, Any] = usage.model_dump(exclude_none=True) if usage is not None else {}
    return {name: value for name, value in known.items() if isinstance(value, (int, float))}


def _cost_of(sample: Any, work: Work | None) -> Cost:
    """Calls, tokens, time and money of an attempt; money only if the price of the model is known."""
    calls = [event for event in sample.events if event.event == "tool"]
    used = [event.output.usage for event in _answers(sample) if event.output.usage is not None]

    def total(*names: str) -> int:
        return sum(getattr(usage, name) or 0 for usage in used for name in names)

    paid = [usage.total_cost for usage in used]
    return Cost(
        calls=len(calls), errors=sum(event.error is not None for event in calls), turns=len(_answers(sample)),
        tokens=total("total_tokens"), input_tokens=total("input_tokens"), output_tokens=total("output_tokens"),
        cache_tokens=total("input_tokens_cache_write", "input_tokens_cache_read"),
        dollars=None if not paid or None in paid else round(sum(paid), 6),
        seconds=round(work.seconds, 2) if work is not None else None, steps=_steps(sample.messages),
    )  # fmt: skip


def _steps(messages: Sequence[Any]) -> list[Step]:
    """The tool calls that were answered; a call of the command line is named after its command: ``irsim run``."""
    given = {call.id: call for message in messages for call in getattr(message, "tool_calls", None) or []}
    steps = []
    for message in (one for one in messages if one.role == "tool"):
        call, tool = given.get(message.tool_call_id), message.function or ""
        if tool == "irsim" and call is not None:
            words = str(call.arguments.get("command", "")).removeprefix("irsim ").split()
            tool = " ".join(["irsim", *words[:1]])
        steps.append(Step(tool=tool, error=message.error is not None, codes=error_codes(_said_by(message))))
    return steps


def replayed_model(attempt: Attempt, model: str, folder: Path) -> Any:
    """A model that answers as recorded, with the ids of the runs that the tools make now, and paths in ``folder``."""
    given = (turn for turn in attempt.messages if turn.role == "assistant")

    def placed(text: str) -> str:
        return text.replace("<folder>", str(folder))

    def answer(messages: list[Any], tools: Any, choice: Any, config: Any) -> Any:
        turn = next(given, None)
        if turn is None:
            raise RecordingEnds(attempt.ended or "the recording has no further answer of the model", attempt.failed)
        names = Names()
        for message in messages:
            if message.role == "tool":
                names.numbered(scrubbed(_said_by(message), [folder, folder.parent]))
        return _output(turn, model, lambda value: with_texts(names.filled(value), placed))

    return get_model("mockllm/replay", custom_outputs=answer, memoize=False)


def drift_of(recorded: Attempt, now: Attempt) -> list[str]:
    """Answers of the tools that differ from the recorded ones."""
    before = [call for turn in recorded.messages for call in turn.calls]
    after = [call for turn in now.messages for call in turn.calls]
    differences = []
    for number, (old, new) in enumerate(zip(before, after, strict=False), 1):
        if old.result_sha and old.result_sha != new.result_sha:
            texts = [json.dumps(call.result, ensure_ascii=False) for call in (old, new)]
            was, became = shorten_pair(texts[0], texts[1], _MAX_DRIFT)
            differences.append(f"call {number}, {old.name}: it was {was}, it is {became}")
    if len(before) != len(after):
        differences.append(f"{len(before)} calls were recorded, {len(after)} were made")
    return differences


def _said_by(message: Any) -> str:
    return message.error.message if message.error is not None else str(message.text)


def _output(turn: Turn, model: str, filled: Callable[[Any], Any]) -> Any:
    calls = [ToolCall(id=call.id, function=call.name, arguments=filled(call.args)) for call in turn.calls]
    message = ChatMessageAssistant(content=filled(turn.text), tool_calls=calls or None, model=model, source="generate")
    # Without usage inspect_ai would count the tokens itself, for which it downloads a table.
    usage = ModelUsage(**(turn.usage or {"input_tokens": 0, "output_tokens": 0, "total_tokens": 0}))
    choice = ChatCompletionChoice(message=message, stop_reason=turn.stop_reason or "stop")
    return ModelOutput(model=model, choices=[choice], usage=usage)
