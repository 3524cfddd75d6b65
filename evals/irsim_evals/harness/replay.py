"""Play a recording again: the answers of the model come from it, the tools do their work anew."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from inspect_ai.model import ChatCompletionChoice, ChatMessageAssistant, ModelOutput, ModelUsage, get_model
from inspect_ai.tool import ToolCall

from irsim_evals.harness.recording import Attempt, RecordingEnds, Turn
from irsim_evals.harness.scrub import Names, scrubbed

__all__ = ["drift_of", "replayed_model"]

_EXCERPT = 160
"""Characters of an answer that a report of drift shows."""


def replayed_model(attempt: Attempt, model: str, folder: Path) -> Any:
    """A model that answers as recorded, with the ids of the runs that the tools make now.

    Args:
        attempt: What was recorded.
        model: Name of the recorded model.
        folder: Folder of the attempt, for paths in arguments.
    """
    answers = [turn for turn in attempt.messages if turn.role == "assistant"]
    given = iter(answers)

    def answer(messages: list[Any], tools: Any, choice: Any, config: Any) -> Any:
        turn = next(given, None)
        if turn is None:
            raise RecordingEnds(attempt.ended or "the recording has no further answer of the model", attempt.failed)
        names = Names()
        for message in messages:
            if message.role == "tool":
                names.numbered(scrubbed(_text(message), [folder, folder.parent]))
        return _output(turn, model, lambda value: _placed(names.filled(value), str(folder)))

    return get_model("mockllm/replay", custom_outputs=answer, memoize=False)


def drift_of(recorded: Attempt, now: Attempt) -> list[str]:
    """What the tools answered otherwise than when it was recorded."""
    before = [call for turn in recorded.messages for call in turn.calls]
    after = [call for turn in now.messages for call in turn.calls]
    found = []
    for number, (old, new) in enumerate(zip(before, after, strict=False), 1):
        if old.result_sha and old.result_sha != new.result_sha:
            was, now_ = _differing(old.result, new.result)
            found.append(f"call {number}, {old.name}: it was {_quoted(was)}, it is {_quoted(now_)}")
    if len(before) != len(after):
        found.append(f"{len(before)} calls were recorded, {len(after)} were made")
    return found


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _differing(old: str, new: str) -> tuple[str, str]:
    """The parts of two texts from a little before the place at which they differ."""
    same = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), min(len(old), len(new)))
    begin = max(same - 20, 0)
    return old[begin : begin + _EXCERPT], new[begin : begin + _EXCERPT]


def _text(message: Any) -> str:
    return message.error.message if message.error is not None else str(message.text)


def _placed(value: Any, folder: str) -> Any:
    if isinstance(value, str):
        return value.replace("<folder>", folder)
    if isinstance(value, dict):
        return {key: _placed(one, folder) for key, one in value.items()}
    return [_placed(one, folder) for one in value] if isinstance(value, list) else value


def _output(turn: Turn, model: str, filled: Callable[[Any], Any]) -> Any:
    calls = [ToolCall(id=call.id, function=call.name, arguments=filled(call.args)) for call in turn.calls]
    message = ChatMessageAssistant(content=filled(turn.text), tool_calls=calls or None, model=model, source="generate")
    # Without usage inspect_ai would count the tokens itself, for which it downloads a table.
    usage = ModelUsage(**(turn.usage or {"input_tokens": 0, "output_tokens": 0, "total_tokens": 0}))
    choice = ChatCompletionChoice(message=message, stop_reason=turn.stop_reason or "stop")
    return ModelOutput(model=model, choices=[choice], usage=usage)
