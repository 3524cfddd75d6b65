"""The page in a host of MCP Apps: a frame in a sandbox, and JSON-RPC over postMessage."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import anyio
import pytest

import irsim_mcp.resources
from irsim.runs import open_run
from irsim_mcp.resources import PAGE
from tests.browser import Watched, until
from tests.mcp.conftest import connected
from tests.runs.replay.conftest import scene

pytestmark = pytest.mark.browser

HOST = Path(__file__).with_name("host.html")
BROKEN = {"content": [{"type": "text", "text": "invalid-scenario: …"}], "isError": True}


@pytest.fixture
def served(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Answers of the server: the page, a result of run_episode, and its run in several parts."""
    monkeypatch.setattr(irsim_mcp.resources, "_MAX_BYTES", 1500)

    async def ask() -> dict[str, Any]:
        async with connected(workspace) as client:
            (page,) = (await client.read_resource(PAGE)).contents
            result = await client.call_tool("run_episode", {"scenario_yaml": scene("</script><b>x"), "seed": 1})
            answers: dict[str, Any] = {}
            assert result.structured_content is not None
            at, total = 0, 1
            while at < total:
                uri = f"irsim://runs/{result.structured_content['run_id']}/replay.json?offset={at}"
                read = await client.read_resource(uri)
                answers[uri] = read.model_dump(mode="json", by_alias=True, exclude_none=True)
                part = json.loads(answers[uri]["contents"][0]["text"])
                at, total = at + len(part["data"]), part["total"]
        return {"page": page.text, "result": result.model_dump(mode="json", by_alias=True), "resources": answers}

    with ThreadPoolExecutor(1) as pool:  # the browser's own loop runs in this one
        return pool.submit(anyio.run, ask).result()


def test_it_shows_the_run_that_the_host_tells_of(served: dict[str, Any], workspace: Path, watched: Watched) -> None:
    assert len(served["resources"]) > 1
    page, frame = hosted(watched, served)
    until(page, "window.log.some(m => m.method === 'ui/notifications/size-changed')")
    first, *_ = page.evaluate("window.log")
    assert first["method"] == "ui/initialize"
    assert first["params"]["protocolVersion"] == "2026-01-26"
    assert set(first["params"]) == {"protocolVersion", "appInfo", "appCapabilities"}
    assert "Waiting" in frame.inner_text("#message")
    assert frame.evaluate("document.documentElement.dataset.theme") == "dark"
    page.evaluate("window.tell('ui/notifications/tool-input', { arguments: {} })")
    page.evaluate("result => window.tell('ui/notifications/tool-result', result)", served["result"])
    until(frame, "document.getElementById('time').max > 0")
    run = open_run("last", workspace)
    assert int(frame.get_attribute("#time", "max")) == run.last_step
    assert frame.inner_text("#outcome") == "collision"
    frame.click("#play")
    until(frame, "document.getElementById('time').value > 3")
    asked = [m["params"]["uri"] for m in page.evaluate("window.log") if m["method"] == "resources/read"]
    assert asked == list(served["resources"])
    page.evaluate("window.tell('ui/notifications/host-context-changed', { theme: 'light' })")
    until(frame, "document.documentElement.dataset.theme === 'light'")
    assert page.evaluate("window.ask('ui/resource-teardown', {})") == {}


@pytest.mark.parametrize(
    ("result", "said"),
    [
        (BROKEN, "The run failed"),
        ({"content": [], "structuredContent": {"outcome": "success"}}, "not recorded"),
        ({"content": [], "structuredContent": {"run_id": "gone-000000"}}, "cannot be read: no such resource"),
    ],
)
def test_it_says_why_there_is_nothing_to_see(
    served: dict[str, Any], watched: Watched, result: dict[str, Any], said: str
) -> None:
    page, frame = hosted(watched, served)
    until(page, "window.log.some(m => m.method === 'ui/notifications/initialized')")
    page.evaluate("result => window.tell('ui/notifications/tool-result', result)", result)
    until(frame, f"document.getElementById('message').textContent.includes('{said}')")


def test_messages_of_others_are_not_heard(served: dict[str, Any], watched: Watched) -> None:
    page, frame = hosted(watched, served)
    until(page, "window.log.some(m => m.method === 'ui/notifications/initialized')")
    message = {"jsonrpc": "2.0", "method": "ui/notifications/tool-result", "params": served["result"]}
    frame.evaluate("message => window.postMessage(message, '*')", message)
    page.evaluate("window.tell('ui/notifications/tool-input', {})")
    until(frame, "document.getElementById('message').textContent.includes('Simulating')")
    assert frame.get_attribute("#time", "max") == "0"


def hosted(watched: Watched, served: dict[str, Any]) -> tuple[Any, Any]:
    """The host and the frame in it."""
    watched.page.goto(HOST.as_uri())
    watched.page.evaluate("given => window.show(given)", served)
    until(watched.page, "window.log.length > 0")
    [frame] = watched.page.main_frame.child_frames
    return watched.page, frame
