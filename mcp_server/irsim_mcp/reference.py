"""Answers of ``lookup`` and of the schema resources. Runs in workers, as it imports the components and the engine."""

from __future__ import annotations

import json
from typing import Any

from irsim.bundled import templates
from irsim.diagnostics.errors import InputError
from irsim.lookup import Answer, TopicError, as_brief_text, as_text, lookup_several, schema_part, topics_of
from irsim.lookup import lookup as look_up
from irsim.lookup.answer import said_once
from irsim.lookup.index import PICTURE
from irsim.runs.files import RunError
from irsim.scenario.yaml.modeline import without_modeline

__all__ = ["explanation", "schema_text"]

_INDEX_TITLE = "Topics that lookup explains"
_MAX_LIST = 3500
"""Number of characters up to which a list of topics is answered in full."""
_INDEX_HELP = (
    "Look up any of these, or a path such as robot.sensors.lidar2d or world.plot. Templates are whole scenarios; "
    "empty-room is the smallest. Units: m, s, rad; heading 0 looks along +x and grows counter-clockwise."
)


def explanation(topic: str, parameters: dict[str, Any] | None) -> str:
    """The explanation of a topic; for a template also its YAML with the parameters filled in.

    Raises:
        RunError: There is no such topic, or a parameter is invalid.
    """
    if parameters:
        return _template(topic.strip(), parameters)
    if len(topics := topics_of(topic)) > 1:
        return _several(topics)
    try:
        answer = look_up(topic)
    except TopicError as error:
        fix = f"did you mean {' or '.join(error.near)}?" if error.near else "lookup without a topic lists all topics"
        raise RunError("unknown-topic", error.message, fix, where="topic") from None
    if answer.kind == "template":
        return _template(answer.topic, {}, answer.read_as)
    if answer.kind != "index":
        answer = _with_usable_best(answer)
        return as_text(answer) + (f"\n\nFor example:\n{answer.example}" if answer.example else "")
    if answer.topic:
        return _list(answer)
    groups = {**answer.groups, **look_up("templates").groups}  # with the purpose of each template
    return f"{as_text(answer.model_copy(update={'title': _INDEX_TITLE, 'groups': groups}))}\n\n{_INDEX_HELP}"


def _list(answer: Answer) -> str:
    """A list of topics; of a long one only the first group is described, and the others are named."""
    if len(text := as_text(answer)) <= _MAX_LIST or len(answer.groups) < 2:
        return text
    (first, keys), *others = answer.groups.items()
    text = as_text(answer.model_copy(update={"groups": {first: keys}, "see": []}))
    before = f"{answer.topic}." if answer.topic == "suites" else ""
    named = [f"{heading}: {', '.join(key.name for key in group)}" for heading, group in others if group]
    return "\n\n".join([text, *named, f"lookup explains each, such as {before}{others[0][1][0].name}"])


def _several(topics: list[str]) -> str:
    """Brief explanations of several topics, each said once."""
    try:
        explanations = lookup_several(topics)
    except TopicError as error:
        fix = f"did you mean {' or '.join(error.near)}?" if error.near else "lookup without a topic lists all topics"
        raise RunError("unknown-topic", error.message, fix, where="topic") from None
    except InputError as error:
        raise RunError("bad-argument", error.message, error.fix, where="topic") from None
    parts = []
    for one in said_once(topics, explanations):
        if isinstance(one, TopicError):
            near = f": did you mean {' or '.join(one.near)}?" if one.near else ""
            parts.append(f"{one.message}{near}")
        elif one.kind == "template":
            brief = _without_picture(one).model_copy(update={"example": None})
            more = f"\nlookup with topic: {one.topic}, alone, returns its YAML." if one.groups else ""
            parts.append(as_brief_text(brief) + more)
        else:
            parts.append(as_brief_text(_with_usable_best(one)))
    return "\n\n".join(f"== {part}" for part in parts)


def schema_text(section: str) -> str:
    """JSON Schema of a part of the language; of all of it for an empty ``section``.

    Raises:
        RunError: There is no such part.
    """
    try:
        part = schema_part(section)
    except TopicError as error:
        fix = f"did you mean {' or '.join(error.near)}?" if error.near else "irsim://schema/scenario has all of it"
        raise RunError("unknown-topic", f"there is no part {section!r} of the schema", fix) from None
    return json.dumps(part, ensure_ascii=False)


def _template(name: str, parameters: dict[str, Any], read_as: str | None = None) -> str:
    try:
        template = templates.load(name)
        text = templates.fill(template, parameters)
    except templates.TemplateError as error:
        where = "topic" if error.code == "unknown-template" else "parameters"
        raise RunError(error.code, error.message, error.fix, where=where) from None
    about = f"{template.purpose} {template.prospect(parameters)}"  # without the path of the picture on this machine
    answer = look_up(name).model_copy(update={"text": about, "see": [], "read_as": read_as})
    given = ", ".join(f"{key}={value}" for key, value in parameters.items()) or "the default parameters"
    return f"{as_text(answer)}\n\nscenario.yaml with {given}:\n```yaml\n{without_modeline(text)}```"


def _without_picture(answer: Answer) -> Answer:
    """An answer without the path of a picture: a path of the server's machine is of no use to a caller."""
    return answer.model_copy(update={"text": answer.text.partition(PICTURE)[0].rstrip()})


def _with_usable_best(answer: Answer) -> Answer:
    """An answer whose first topic is told without the path of a picture."""
    return answer if answer.best is None else answer.model_copy(update={"best": _without_picture(answer.best)})
