"""Resources: parts of the schema, templates, documentation, recorded runs, the page that replays them; completions.

The tools work without them. One read returns at most 1 MB.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Any

from mcp.server import MCPServer
from mcp.server.apps import APP_MIME_TYPE, Apps
from mcp.server.mcpserver.exceptions import ResourceNotFoundError, ToolError
from mcp.server.mcpserver.resources import FunctionResource
from mcp.types import Completion, CompletionArgument, CompletionContext, PromptReference, ResourceTemplateReference

from irsim.common import data_files as resources
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import nearest
from irsim.runs.store import ARTIFACTS
from irsim_mcp.answers import failure
from irsim_mcp.prompts import DIFFICULTIES, drives, template_names
from irsim_mcp.services import Services

__all__ = [
    "DOC",
    "PAGE",
    "RUN",
    "SCHEMA",
    "SECTIONS",
    "TEMPLATE",
    "add_completions",
    "add_docs",
    "add_resources",
    "add_run_resources",
    "media_type",
    "replay_app",
    "topics",
    "uri",
]


SECTIONS = (
    "scenario", "world", "robot", "obstacle", "gui",
    "behavior", "bridge", "distribution", "kinematics", "map", "planner", "sensor", "shape",
)  # fmt: skip
SCHEMA, TEMPLATE = "irsim://schema/{section}", "irsim://templates/{name}"


def add_resources(server: MCPServer, services: Services) -> None:
    """Register these resources with a server."""

    async def schema(section: str) -> str:
        """JSON Schema of a section, key or component of scenario files, such as world or robot.sensors.lidar2d."""
        try:
            asked = "" if section == "scenario" else section
            return await services.reference("schema", "section", section=asked)
        except ToolError as error:
            raise ResourceNotFoundError(str(error)) from None

    server.resource(SCHEMA, title="JSON Schema of a part", mime_type="application/schema+json")(schema)
    server.resource(TEMPLATE, title="Scenario template", mime_type="application/yaml")(template)
    deeper = "With units and defaults; irsim://schema/robot.sensors.lidar2d goes deeper."
    for section in SECTIONS:
        _add(server, schema, "schema", section, "JSON Schema of", deeper, "application/schema+json")
    others = "A complete scenario with its default parameters; the tool lookup fills in others."
    for name in template_names():
        _add(server, template, "templates", name, "Template", others, "application/yaml")


def _add(
    server: MCPServer, read: Callable[[str], Any], kind: str, name: str, title: str, description: str, mime_type: str
) -> None:
    """Register ``irsim://KIND/NAME``, which a function reads by the name."""
    server.add_resource(
        FunctionResource.from_function(
            functools.partial(read, name),
            uri=f"irsim://{kind}/{name}",
            name=f"{'template' if kind == 'templates' else kind}-{name}",
            title=f"{title} {name}",
            description=description,
            mime_type=mime_type,
        )
    )


def template(name: str) -> str:
    """A complete scenario as YAML, to start from."""
    from irsim.bundled.templates import TemplateError, load
    from irsim.scenario.yaml.modeline import without_modeline

    try:
        return without_modeline(load(name).text)
    except TemplateError as error:
        raise ResourceNotFoundError(str(error)) from None


DOC = "irsim://docs/{topic}{?offset,limit}"
_MAX_BYTES = 1_000_000
"""Size of the largest part of a page or a run that one read returns."""
_README = "readme"


def topics() -> list[str]:
    """Names of the pages: ``readme``, and the references of the skills by file name."""
    return sorted((_README, *_pages()))


def add_docs(server: MCPServer) -> None:
    """Register the resource template and each page with a server."""
    description = "A page of the documentation as Markdown. At most 1 MB per read: offset and limit select characters."
    server.resource(DOC, name="docs", title="Documentation", description=description, mime_type="text/markdown")(page)
    part = "?offset=…&limit=… selects a part, counted in characters."
    for topic in topics():
        _add(server, page, "docs", topic, "Documentation:", part, "text/markdown")


def page(topic: str, offset: int = 0, limit: int = _MAX_BYTES) -> str:
    """A page of the documentation, or a part of it."""
    if offset < 0 or limit < 1:
        raise ResourceNotFoundError("bad-argument: offset must be at least 0, limit at least 1 (both in characters).")
    part = _text(topic)[offset : offset + min(limit, _MAX_BYTES)]
    return part.encode()[:_MAX_BYTES].decode(errors="ignore")


def _text(topic: str) -> str:
    if topic == _README:
        root = resources.checkout()
        if root is not None:
            return (root / "README.md").read_text(encoding="utf-8")
        from importlib.metadata import metadata

        return str(metadata("irsim-mcp").get_payload())  # type: ignore[attr-defined]
    pages = _pages()
    if topic not in pages:
        near = nearest(topic, topics())
        fix = f"Did you mean {near}?" if near else f"The pages are {', '.join(topics())}."
        raise ResourceNotFoundError(f"unknown-topic: there is no page {clean(topic)!r}. {fix}")
    return pages[topic].read_text(encoding="utf-8")


def _pages() -> dict[str, Path]:
    """Files of the pages by name; of two pages with the same name, the second has its skill as prefix."""
    pages: dict[str, Path] = {}
    for path in sorted(resources.skills_directory().glob("*/references/*.md")):
        name = path.stem if path.stem not in pages else f"{path.parents[1].name}-{path.stem}"
        pages[name] = path
    return pages


RUN = "irsim://runs/{run_id}/{artifact}{?from_step,to_step,every,robot,offset}"
_TYPES = {".json": "application/json", ".csv": "text/csv", ".yaml": "application/yaml"}


def media_type(uri: str) -> str | None:
    """Media type of a part of a run; None for other resources. A part from the middle of a file is plain text."""
    path, _, query = uri.partition("?")
    if not path.startswith("irsim://runs/"):
        return None
    middle = re.search(r"(^|&)offset=0*[1-9]", query) and not path.endswith("/replay.json")
    return "text/plain" if middle else _TYPES.get(PurePosixPath(path).suffix, "text/plain")


def uri(run_id: str, artifact: str) -> str:
    """URI of an artifact of a run."""
    return f"irsim://runs/{run_id}/{artifact}"


def add_run_resources(server: MCPServer, services: Services) -> None:
    """Register the resource template with a server."""

    async def run_artifact(
        run_id: str,
        artifact: str,
        from_step: str = "0",
        to_step: str | None = None,
        every: str = "1",
        robot: str | None = None,
        offset: str = "0",
    ) -> str:
        try:
            part = await services.run_job(
                "artifact",
                run_id,
                seconds=services.limits.check_seconds,
                name=artifact,
                from_step=_number("from_step", from_step),
                to_step=None if to_step is None else _number("to_step", to_step),
                every=_number("every", every, least=1),
                robot=robot,
                offset=_number("offset", offset),
                most=_MAX_BYTES,
            )
        except ToolError as error:
            raise ResourceNotFoundError(str(error)) from None
        return str(part["text"])

    description = (
        f"Part of a recorded run: {', '.join(ARTIFACTS)}. At most 1 MB per read: files and the data of replay.json "
        "continue with offset (characters), events and traces with from_step (their next_step); every=N takes every "
        "Nth step of a trace; robot selects one object and, in trace.json, adds its ranges."
    )
    server.resource(RUN, name="run", title="Recorded run", description=description, mime_type="text/plain")(
        run_artifact
    )


def _number(name: str, text: str, *, least: int = 0) -> int:
    """A whole number in a URI.

    Raises:
        ToolError: The text is not a whole number, or it is less than ``least``.
    """
    if not re.fullmatch("[0-9]{1,15}", text) or int(text) < least:
        what = f"{name} must be a whole number from {least} on, got {clean(text, 40)!r}"
        raise failure("bad-argument", what, where=name, fix=f"give a whole number from {least} on")
    return int(text)


PAGE = "ui://irsim/replay"


def replay_app() -> Apps:
    """The extension with the page."""
    apps = Apps()
    apps.add_resource(
        FunctionResource(
            uri=PAGE,
            name="replay",
            title="Replay of a run",
            description="Shows what run_episode simulated; for hosts, not for models to read.",
            mime_type=APP_MIME_TYPE,
            meta={"ui": {"prefersBorder": True}},
            fn=_html,
        )
    )
    return apps


def _html() -> str:
    from irsim.runs.replay.page import page

    return page()


_MAX_VALUES = 100
"""Number of values that one completion offers."""


def add_completions(server: MCPServer, services: Services) -> None:
    """Register the completions with a server."""
    workspace = services.workspace
    choices: dict[tuple[str, str], Callable[[], Iterable[str]]] = {
        ("design_scenario", "kinematics"): drives,
        ("design_scenario", "difficulty"): lambda: DIFFICULTIES,
        ("debug_run", "run_id"): workspace.runs,
        ("compare_policies", "scenario"): lambda: (*workspace.scenarios(), *template_names()),
        (SCHEMA, "section"): lambda: SECTIONS,
        (TEMPLATE, "name"): template_names,
        (DOC, "topic"): topics,
        (RUN, "run_id"): workspace.runs,
        (RUN, "artifact"): lambda: ARTIFACTS,
    }

    async def complete(
        ref: PromptReference | ResourceTemplateReference,
        argument: CompletionArgument,
        context: CompletionContext | None,
    ) -> Completion:
        of = ref.name if isinstance(ref, PromptReference) else ref.uri
        known: Iterable[str] = ()
        if (of, argument.name) in choices:
            with suppress(OSError):
                known = choices[of, argument.name]()
        values = [choice for choice in known if choice.startswith(argument.value) and clean(choice, 1000) == choice]
        return Completion(values=values[:_MAX_VALUES], total=len(values), has_more=len(values) > _MAX_VALUES)

    completing: Callable[[], Callable[..., Any]] = server.completion  # the SDK declares no types for it
    completing()(complete)
