"""Resources: parts of the JSON Schema of scenario files, and the templates. The tools work without them."""

from __future__ import annotations

import functools

from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ResourceNotFoundError, ToolError
from mcp.server.mcpserver.resources import FunctionResource

from irsim_mcp.prompts import template_names
from irsim_mcp.services import Services

__all__ = ["SCHEMA", "SECTIONS", "TEMPLATE", "add_resources"]

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
    for section in SECTIONS:
        server.add_resource(
            FunctionResource.from_function(
                functools.partial(schema, section),
                uri=f"irsim://schema/{section}",
                name=f"schema-{section}",
                title=f"JSON Schema of {section}",
                description="With units and defaults; irsim://schema/robot.sensors.lidar2d goes deeper.",
                mime_type="application/schema+json",
            )
        )
    for name in template_names():
        server.add_resource(
            FunctionResource.from_function(
                functools.partial(template, name),
                uri=f"irsim://templates/{name}",
                name=f"template-{name}",
                title=f"Template {name}",
                description="A complete scenario with its default parameters; the tool lookup fills in others.",
                mime_type="application/yaml",
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
