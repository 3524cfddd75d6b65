"""Whatever the program registers has its place on the site."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest
from mcp import Client

from irsim.benchmarks.suite import SUITES
from irsim.bundled import templates
from irsim.cli.app import COMMANDS
from irsim.common.event_kinds import EVENTS
from irsim.compat import DIFFERENCES
from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.lookup.metrics import METRIC_TOPICS
from irsim.lookup.schema_walk import paths
from irsim.lookup.things import ALL_GUIDES
from irsim.options.registry import REGISTRIES
from irsim.scenario.model.json_schema import json_schema
from irsim_mcp.server import build_server
from tests.site.pages import read_pages, run

pytestmark = [pytest.mark.site, pytest.mark.one_python]


def missing(html: Path, page: str, anchors: list[str]) -> list[str]:
    known = set(read_pages(html)[f"{page}.html"].ids)
    return [anchor for anchor in anchors if anchor not in known]


def test_keys_of_scenarios(html: Path) -> None:
    """Every path of the schema leads to an anchor; obstacles, groups and local behaviors share anchors."""
    from language import schema_anchor

    pages, absent = read_pages(html), []
    for path, _ in paths(json_schema()):
        page, _, anchor = schema_anchor(path).partition("#")
        place = pages.get(f"{page}.html") or pages.get(f"{page}/index.html")
        if place is None or (anchor not in place.ids and path[-1] not in ("name", *_names())):
            absent.append(".".join(path))
    assert absent == []


def _names() -> set[str]:
    """Names of components: their pages have them."""
    return {name for registry in REGISTRIES.values() for name in registry.names()}


@pytest.mark.parametrize("kind", sorted(REGISTRIES))
def test_components(html: Path, kind: str) -> None:
    pages = read_pages(html)
    for feature in REGISTRIES[kind].features():
        page = f"reference/{kind}/{feature.name}"
        assert f"{page}.html" in pages
        keys = [key for key in feature.options.model_fields if key != "name"]
        assert missing(html, page, [f"{kind}.{feature.name}.{key}" for key in keys]) == []


def test_codes_metrics_events_and_things(html: Path) -> None:
    assert missing(html, "reference/codes", [*CODES, *TOOL_CODES]) == []
    assert missing(html, "reference/metrics", list(METRIC_TOPICS)) == []
    assert missing(html, "reference/events", list(EVENTS)) == []
    assert missing(html, "reference/things", list(ALL_GUIDES)) == []
    assert missing(html, "irsim/compat/README", list(DIFFERENCES)) == []


def test_templates_and_suites(html: Path) -> None:
    pages = read_pages(html)
    assert [name for name in templates.names() if f"gallery/{name}.html" not in pages] == []
    assert [name for name in SUITES.names() if f"suites/{name}.html" not in pages] == []
    for template in templates.load_all():
        keys = [f"{template.name}.{key}" for key in template.parameters]
        assert missing(html, f"gallery/{template.name}", keys) == []
        assert len(pages[f"gallery/{template.name}.html"].frames) == 1


def test_commands_and_options(html: Path) -> None:
    from commands import commands

    every = commands()
    assert {name.split()[1] for name in every} == set(COMMANDS)
    for name, command in every.items():
        page = f"reference/commands/{'-'.join(name.split()[1:])}"
        shown = [one for one in command.params if one.param_type_name == "option" and not one.hidden]
        options = [opt for one in shown for opt in (*one.opts, *one.secondary_opts) if one.name != "help"]
        if not getattr(command, "commands", None):
            assert missing(html, page, options) == [], name


def test_tools_prompts_and_their_arguments(html: Path) -> None:
    async def listed() -> list[str]:
        async with Client(build_server(Path(), writing=True)) as client:
            tools = (await client.list_tools()).tools
            prompts = (await client.list_prompts()).prompts
        arguments = [f"{tool.name}.{name}" for tool in tools for name in tool.input_schema.get("properties", {})]
        return [*(f"tool-{tool.name}" for tool in tools), *arguments, *(prompt.name for prompt in prompts)]

    assert missing(html, "reference/tools", run(listed)) == []


@pytest.mark.parametrize("module", ["irsim", "irsim.policies", "irsim.policies.networks", "irsim.plugins", "irsim.runs",
                                    "irsim.learning", "irsim.testing"])  # fmt: skip
def test_public_names(html: Path, module: str) -> None:
    names = [name for name in importlib.import_module(module).__all__ if not name.startswith("__")]
    assert missing(html, f"reference/python/{module}", [f"{module}.{name}" for name in names]) == []


def test_methods_of_the_environment(html: Path) -> None:
    from irsim.env import Env

    methods = [name for name in dir(Env) if not name.startswith("_") and callable(getattr(Env, name))]
    documented = [name for name in methods if getattr(Env, name).__doc__]
    assert missing(html, "reference/python/irsim", [f"irsim.Env.{name}" for name in documented]) == []
