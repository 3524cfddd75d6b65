"""What ``lookup`` and the resources of the schema answer. Runs in workers: it reads the features, and so the engine."""

from __future__ import annotations

import json
from typing import Any

from irsim.bundled import templates
from irsim.lookup import TopicError, as_text, schema_part
from irsim.lookup import lookup as look_up
from irsim.runs.files import RunError
from irsim.scenario.yaml.modeline import without_modeline

__all__ = ["explained", "schema_text"]

_INDEX_TITLE = "What lookup knows"
_INDEX_HELP = (
    "Ask for any of these, or for a path such as robot.sensors.lidar2d or world.plot. Templates are whole scenarios; "
    "empty-room is the smallest. Units: m, s, rad; heading 0 looks along +x and grows counter-clockwise."
)


def explained(topic: str, parameters: dict[str, Any] | None) -> str:
    """What is known of a topic; of a template its YAML with parameters filled in.

    Raises:
        RunError: Nothing goes by that name, or a parameter is none.
    """
    if parameters:
        return _template(topic.strip(), parameters)
    try:
        answer = look_up(topic)
    except TopicError as error:
        fix = f"did you mean {' or '.join(error.near)}?" if error.near else "lookup without a topic lists what there is"
        raise RunError("unknown-topic", error.message, fix, where="topic") from None
    if answer.kind == "template":
        return _template(answer.topic, {})
    if answer.kind != "index":
        return as_text(answer) + (f"\n\nFor example:\n{answer.example}" if answer.example else "")
    if answer.topic:
        return as_text(answer)
    groups = {**answer.groups, **look_up("templates").groups}  # with what they are for
    return f"{as_text(answer.model_copy(update={'title': _INDEX_TITLE, 'groups': groups}))}\n\n{_INDEX_HELP}"


def schema_text(section: str) -> str:
    """JSON Schema of a part of the language; empty for all of it.

    Raises:
        RunError: There is no such part.
    """
    try:
        part = schema_part(section)
    except TopicError as error:
        fix = f"did you mean {' or '.join(error.near)}?" if error.near else "irsim://schema/scenario has all of it"
        raise RunError("unknown-topic", f"no part of the schema is called {section!r}", fix) from None
    return json.dumps(part, ensure_ascii=False)


def _template(name: str, parameters: dict[str, Any]) -> str:
    try:
        template = templates.load(name)
        text = templates.fill(template, parameters)
    except templates.TemplateError as error:
        where = "topic" if error.code == "unknown-template" else "parameters"
        raise RunError(error.code, error.message, error.fix, where=where) from None
    answer = look_up(name).model_copy(update={"see": []})
    given = ", ".join(f"{key}={value}" for key, value in parameters.items()) or "the default parameters"
    return f"{as_text(answer)}\n\nscenario.yaml with {given}:\n```yaml\n{without_modeline(text)}```"
