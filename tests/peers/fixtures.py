"""Our own server with the fixed-name tools, resources and prompts that the conformance suites call.

``python -m tests.peers.fixtures PORT`` serves it over HTTP, the same way as ``irsim-mcp --http PORT``.
"""

from __future__ import annotations

import base64
import json
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import anyio
from mcp import MCPError
from mcp.server.mcpserver import Context
from mcp.server.mcpserver.exceptions import ToolError
from mcp.server.mcpserver.prompts.base import UserMessage
from mcp.types import (
    MISSING_REQUIRED_CLIENT_CAPABILITY,
    AudioContent,
    ClientCapabilities,
    EmbeddedResource,
    ImageContent,
    MissingRequiredClientCapabilityErrorData,
    SamplingCapability,
    SamplingMessage,
    TextContent,
    TextResourceContents,
)
from pydantic import BaseModel, Field

from irsim_mcp.hosts import address
from irsim_mcp.http import serve
from irsim_mcp.server import IrsimServer, build_server

PNG = base64.b64encode(
    bytes.fromhex(
        "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de"
        "0000000c49444154789c63f8cfc0000003010100c9fe92ef0000000049454e44ae426082"
    )
).decode()
WAV = base64.b64encode(
    b"RIFF\x26\x00\x00\x00WAVEfmt \x10\x00\x00\x00\x01\x00\x01\x00\x40\x1f\x00\x00\x40\x1f\x00\x00\x01\x00\x08\x00"
    b"data\x02\x00\x00\x00\x80\x80"
).decode()
Ctx = Context[Any, Any]


class Person(BaseModel):
    name: str = Field(default="John Doe", description="Name")
    age: int = Field(default=30, description="Age")
    score: float = Field(default=95.5, description="Score")
    status: Literal["active", "inactive", "pending"] = Field(default="active", description="Status")
    verified: bool = Field(default=True, description="Verified")


class Response(BaseModel):
    response: str = Field(description="Response")


def _resource(uri: str, kind: str, text: str) -> EmbeddedResource:
    return EmbeddedResource(resource=TextResourceContents(uri=uri, mime_type=kind, text=text))


def add_tools(server: IrsimServer) -> None:
    def tool(function: Callable[..., Any]) -> None:
        server.add_tool(function, description=f"Fixture {function.__name__}.", structured_output=False)

    @tool
    def test_simple_text() -> list[TextContent]:
        return [TextContent(text="This is a simple text response for testing.")]

    @tool
    def test_image_content() -> list[ImageContent]:
        return [ImageContent(data=PNG, mime_type="image/png")]

    @tool
    def test_audio_content() -> list[AudioContent]:
        return [AudioContent(data=WAV, mime_type="audio/wav")]

    @tool
    def test_embedded_resource() -> list[EmbeddedResource]:
        return [_resource("test://embedded-resource", "text/plain", "This is an embedded resource content.")]

    @tool
    def test_multiple_content_types() -> list[TextContent | ImageContent | EmbeddedResource]:
        return [
            TextContent(text="Multiple content types test:"),
            ImageContent(data=PNG, mime_type="image/png"),
            _resource("test://mixed-content-resource", "application/json", json.dumps({"test": "data", "value": 123})),
        ]

    @tool
    def test_error_handling() -> str:
        raise ToolError("This tool intentionally returns an error for testing")

    @tool
    async def test_tool_with_progress(ctx: Ctx) -> str:
        for done in (0, 50, 100):
            await ctx.report_progress(done, 100, f"{done} of 100")
            await anyio.sleep(0.05)
        return "done"

    @tool
    def test_missing_capability(ctx: Ctx) -> str:
        declared = ctx.session.client_capabilities
        if declared is None or declared.sampling is None:
            needed = ClientCapabilities(sampling=SamplingCapability())
            data = MissingRequiredClientCapabilityErrorData(required_capabilities=needed)
            missing = data.model_dump(mode="json", by_alias=True, exclude_none=True)
            raise MCPError(MISSING_REQUIRED_CLIENT_CAPABILITY, "this tool needs sampling", missing)
        return "the client can sample"

    @tool
    async def test_sampling(prompt: str, ctx: Ctx) -> str:
        message = SamplingMessage(role="user", content=TextContent(text=prompt))
        answer = await ctx.session.create_message(messages=[message], max_tokens=100)
        return f"LLM response: {getattr(answer.content, 'text', '')}"

    @tool
    async def test_elicitation(message: Annotated[str, Field(description="Shown")], ctx: Ctx) -> str:
        answer = await ctx.elicit(message, Response)
        return f"User response: {answer.action}"

    @tool
    async def test_elicitation_sep1034_defaults(ctx: Ctx) -> str:
        answer = await ctx.elicit("Please give your data", Person)
        return f"Elicitation completed: {answer.action}"

    @tool
    def json_schema_2020_12_tool(name: str = "", address: dict[str, str] | None = None) -> str:
        return name

    schemas = {tool.name: tool for tool in server._tool_manager.list_tools()}
    schemas["json_schema_2020_12_tool"].parameters = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "type": "object",
        "$defs": {
            "address": {
                "$anchor": "addressDef",
                "type": "object",
                "properties": {"street": {"type": "string"}, "city": {"type": "string"}},
            }
        },
        "properties": {
            "name": {"type": "string"},
            "address": {"$ref": "#/$defs/address"},
            "contactMethod": {"type": "string", "enum": ["phone", "email"]},
            "phone": {"type": "string"},
            "email": {"type": "string"},
        },
        "allOf": [{"anyOf": [{"required": ["phone"]}, {"required": ["email"]}]}],
        "if": {"properties": {"contactMethod": {"const": "phone"}}, "required": ["contactMethod"]},
        "then": {"required": ["phone"]},
        "else": {"required": ["email"]},
        "additionalProperties": False,
    }


def add_resources(server: IrsimServer) -> None:
    @server.resource("test://static-text", mime_type="text/plain")
    def text() -> str:
        return "This is the content of the static text resource."

    @server.resource("test://static-binary", mime_type="image/png")
    def binary() -> bytes:
        return base64.b64decode(PNG)

    @server.resource("test://watched-resource", mime_type="text/plain")
    def watched() -> str:
        return "Watched resource content"

    @server.resource("test://template/{id}/data", mime_type="application/json")
    def template(id: str) -> str:
        return json.dumps({"id": id, "templateTest": True, "data": f"Data for ID: {id}"})


def add_prompts(server: IrsimServer) -> None:
    def prompt(function: Callable[..., Any]) -> None:
        server.prompt(description=f"Fixture {function.__name__}.")(function)

    @prompt
    def test_simple_prompt() -> str:
        return "This is a simple prompt for testing."

    @prompt
    def test_prompt_with_arguments(arg1: str, arg2: str) -> str:
        return f"Prompt with arguments: arg1='{arg1}', arg2='{arg2}'"

    @prompt
    def test_prompt_with_embedded_resource(resourceUri: str) -> list[UserMessage]:
        content = _resource(resourceUri, "text/plain", "Embedded resource content for testing.")
        return [UserMessage(content=content), UserMessage(content="Please process the embedded resource above.")]

    @prompt
    def test_prompt_with_image() -> list[UserMessage]:
        image = ImageContent(data=PNG, mime_type="image/png")
        return [UserMessage(content=image), UserMessage(content="Please analyze the image above.")]


def main() -> None:
    server = build_server(Path(tempfile.mkdtemp(prefix="irsim-peers-")))
    add_tools(server)
    add_resources(server)
    add_prompts(server)
    serve(server, address(sys.argv[1]), None)


if __name__ == "__main__":
    main()
