"""``lookup``: what scenarios may contain, and templates to start from."""

from __future__ import annotations

from typing import Annotated, Any

from mcp.types import TextContent
from pydantic import Field

from irsim.text import clean
from irsim_mcp.errors import failure
from irsim_mcp.services import Services
from irsim_mcp.tool import StrictTool, strict

__all__ = ["tool"]

_DESCRIPTION = """
    Explain what scenario files may contain, and give templates to start from. Call it first, without a topic: an index
    of sections, components (behaviors, drives, sensors, shapes), templates and error codes. Then with a topic: a
    template name gives a complete scenario as YAML, with `parameters` filled in on request; a key or path
    ('robot.sensors.lidar2d', 'vel_max'), a component ('dash'), a code ('unknown-key'), a metric ('spl') or any word
    ('parking') gives meaning, unit, range, default and an example. Returns text. Start from the nearest template. Next:
    edit the YAML and call validate_scenario.
"""
_INDEX_TITLE = "What lookup knows"
_INDEX_HELP = (
    "Ask for any of these, or for a path such as robot.sensors.lidar2d or world.plot. Templates are whole scenarios; "
    "empty-room is the smallest. Units: m, s, rad; heading 0 looks along +x and grows counter-clockwise."
)


def tool(services: Services) -> StrictTool:
    """Make the tool."""
    most = services.limits.text

    def lookup(
        topic: Annotated[str, Field(max_length=200, description="Empty for the index.")] = "",
        parameters: Annotated[
            dict[str, str | bool | int | float] | None,
            Field(description='Of a template, such as {"width": 1.4}; its answer lists them.'),
        ] = None,
    ) -> list[TextContent]:
        text = _template(topic.strip(), parameters) if parameters else _answer(topic)
        if len(text) > most:
            text = text[:most] + "\n… cut here: ask for a more special topic"
        return [TextContent(type="text", text=text)]

    return strict(
        lookup, title="Look up the language and templates", description=_DESCRIPTION, read_only=True, idempotent=True
    )


def _answer(topic: str) -> str:
    from irsim.lookup import TopicError, as_text
    from irsim.lookup import lookup as look_up

    try:
        answer = look_up(topic)
    except TopicError as error:
        fix = f"did you mean {' or '.join(error.near)}?" if error.near else "lookup without a topic lists what there is"
        raise failure("unknown-topic", f"nothing is called {clean(topic)!r}", where="topic", fix=fix) from None
    if answer.kind == "template":
        return _template(answer.topic, {})
    if answer.kind != "index":
        return as_text(answer) + (f"\n\nFor example:\n{answer.example}" if answer.example else "")
    if answer.topic:
        return as_text(answer)
    groups = {**answer.groups, **look_up("templates").groups}  # with what they are for
    return f"{as_text(answer.model_copy(update={'title': _INDEX_TITLE, 'groups': groups}))}\n\n{_INDEX_HELP}"


def _template(name: str, parameters: dict[str, Any]) -> str:
    """A template's YAML, filled in, and its parameters."""
    from irsim import templates
    from irsim.lookup import as_text
    from irsim.lookup import lookup as look_up
    from irsim.modeline import without_modeline

    try:
        template = templates.load(name)
        text = templates.fill(template, parameters)
    except templates.TemplateError as error:
        where = "topic" if error.code == "unknown-template" else "parameters"
        raise failure(error.code, error.message, where=where, fix=error.fix) from None
    answer = look_up(name).model_copy(update={"see": []})
    given = ", ".join(f"{key}={value}" for key, value in parameters.items()) or "the default parameters"
    return f"{as_text(answer)}\n\nscenario.yaml with {given}:\n```yaml\n{without_modeline(text)}```"
