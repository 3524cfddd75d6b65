"""Prompts, completions and pages of the documentation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from mcp import Client, MCPError
from mcp.types import PromptReference, ResourceTemplateReference, TextContent

from irsim.options.registry import KINEMATICS
from irsim_mcp.prompts import drives, template_names
from tests.mcp.conftest import CRASH, ERAS, ROOM, Caller

pytestmark = pytest.mark.anyio

ARGUMENTS = {
    "design_scenario": {"goal": True, "kinematics": False, "difficulty": False},
    "debug_run": {"run_id": True},
    "compare_policies": {"scenario": True},
}


async def filled(client: Client, name: str, arguments: dict[str, str]) -> str:
    (message,) = (await client.get_prompt(name, arguments)).messages
    assert message.role == "user"
    assert isinstance(message.content, TextContent)
    return message.content.text


async def completed(
    client: Client, ref: PromptReference | ResourceTemplateReference, name: str, value: str
) -> list[str]:
    return (await client.complete(ref, {"name": name, "value": value})).completion.values


@pytest.mark.parametrize("era", ERAS)
async def test_list(client: Caller) -> None:
    prompts = (await client.list_prompts()).prompts
    assert {p.name: {a.name: a.required for a in p.arguments or ()} for p in prompts} == ARGUMENTS
    assert all(p.title and p.description and all(a.description for a in p.arguments or ()) for p in prompts)


async def test_every_prompt_names_tools_that_there_are(client: Caller, workspace: Path) -> None:
    (workspace / "crash.yaml").write_text(CRASH, encoding="utf-8")
    run_id = (await client.data("run_episode", scenario_yaml=CRASH))["run_id"]
    job = (await client.data("benchmark", scenarios=[CRASH], seeds=1))["job_id"]
    tools = {tool.name for tool in (await client.list_tools()).tools}
    views = {"collisions", "closest"}
    texts = [
        await filled(client, "design_scenario", {"goal": 'ten robots\nthat "swap" places'}),
        await filled(client, "debug_run", {"run_id": run_id}),
        await filled(client, "debug_run", {"run_id": "last"}),
        await filled(client, "debug_run", {"run_id": job}),
        await filled(client, "compare_policies", {"scenario": "crash.yaml"}),
        await filled(client, "compare_policies", {"scenario": "crossing"}),
    ]
    assert await client.data("inspect_run", run_id=run_id, view="closest")
    assert "\"ten robots that 'swap' places\"" in texts[0]
    assert f"get_job with job_id={job} until it has ended, then inspect_run with run_id={job}" in texts[3]
    assert "the template crossing" in texts[5]
    for text in texts:
        assert len(text) < 2000
        assert set(re.findall(r"\b[a-z]+_[a-z]+\b", text)) - tools <= {"run_id", "job_id"}
        assert set(re.findall(r'view="(\w+)"', text)) <= views


@pytest.mark.parametrize("era", ERAS)
@pytest.mark.parametrize(
    ("name", "arguments", "said"),
    [
        ("design_scenario", {}, "needs goal. Fix: its arguments are goal, kinematics, difficulty"),
        ("design_scenario", {"goal": "x", "kinematics": "omny"}, "did you mean omni?"),
        ("design_scenario", {"goal": "x", "difficulty": "brutal"}, "give one of easy, medium, hard"),
        ("design_scenario", {"goal": "x", "color": "red"}, "has no argument color"),
        ("debug_run", {"run_id": "room-000000"}, "unknown-run: there is no run 'room-000000'"),
        ("debug_run", {"run_id": "../../etc"}, "unknown-run"),
        ("compare_policies", {"scenario": "../room.yaml"}, "path-outside-workspace"),
        ("compare_policies", {"scenario": "no.yaml"}, "file-not-found"),
        ("design", {}, "there is no prompt 'design'"),
    ],
)
async def test_what_does_not_fit_is_told(
    client: Caller, workspace: Path, name: str, arguments: dict[str, str], said: str
) -> None:
    with pytest.raises(MCPError) as caught:
        await client.get_prompt(name, arguments)
    assert caught.value.error.code == -32602
    assert said in caught.value.error.message


def test_drives_are_those_registered() -> None:
    assert set(drives()) == set(KINEMATICS.names())


@pytest.mark.parametrize("era", ERAS)
async def test_completions(client: Caller, workspace: Path) -> None:
    for name in ("crossing-mine.yaml", "room.yaml", "evil\x1b[2J.yaml"):
        (workspace / name).write_text(ROOM, encoding="utf-8")
    (workspace / "link.yaml").symlink_to("/etc/passwd")
    design, debug, compare = (PromptReference(name=name) for name in ARGUMENTS)
    assert await completed(client, debug, "run_id", "") == []
    run_id = (await client.data("run_episode", scenario_path="room.yaml"))["run_id"]
    templates = {t.name: t.uri_template for t in (await client.list_resource_templates()).resource_templates}
    run, docs = (ResourceTemplateReference(uri=templates[name]) for name in ("run", "docs"))
    assert await completed(client, design, "kinematics", "o") == ["omni", "omni_angular"]
    assert await completed(client, design, "difficulty", "") == ["easy", "medium", "hard"]
    assert await completed(client, debug, "run_id", "room") == [run_id]
    crossings = await completed(client, compare, "scenario", "cross")
    assert crossings == ["crossing-mine.yaml", *(name for name in template_names() if name.startswith("cross"))]
    everything = await completed(client, compare, "scenario", "")
    assert "room.yaml" in everything
    assert not {"link.yaml", "evil\x1b[2J.yaml"} & set(everything)
    assert await completed(client, run, "run_id", "") == [run_id]
    assert await completed(client, run, "artifact", "trace") == ["trace.json", "trace.csv"]
    assert await completed(client, docs, "topic", "sens") == ["sensors"]
    schema = ResourceTemplateReference(uri="irsim://schema/{section}")
    assert await completed(client, schema, "section", "s") == ["scenario", "sensor", "shape"]
    for ref, name in ((design, "goal"), (design, "nonsense"), (PromptReference(name="nothing"), "x")):
        assert await completed(client, ref, name, "") == []


@pytest.mark.parametrize("era", ERAS)
async def test_pages(client: Caller) -> None:
    async def read(uri: str) -> str:
        (content,) = (await client.read_resource(uri)).contents
        return str(content.text)  # type: ignore[union-attr]

    listed = {str(item.uri) for item in (await client.list_resources()).resources}
    assert {"irsim://docs/readme", "irsim://docs/behaviors", "irsim://docs/diagnostics"} <= listed
    whole = await read("irsim://docs/behaviors")
    assert whole.startswith("# ")
    parts = [await read(f"irsim://docs/behaviors?offset={start}&limit=1000") for start in range(0, len(whole), 1000)]
    assert "".join(parts) == whole
    assert await read(f"irsim://docs/behaviors?offset={len(whole) + 5}") == ""
    for uri, said in (
        ("irsim://docs/behaviour", "Did you mean behaviors?"),
        ("irsim://docs/..", "Unknown|no page|not"),
        ("irsim://docs/%2e%2e%2fsecret", "Unknown|no page|not"),
        ("irsim://docs/readme?offset=-1", "offset must be at least 0"),
    ):
        with pytest.raises(MCPError) as caught:
            await client.read_resource(uri)
        assert re.search(said, caught.value.error.message)


async def test_pages_are_cut_at_a_megabyte(monkeypatch: pytest.MonkeyPatch) -> None:
    from irsim_mcp import resources

    monkeypatch.setattr(resources, "_text", lambda topic: "ä" * 2_000_000)
    assert len(resources.page("readme").encode()) == 1_000_000
    assert resources.page("readme", 1_999_999) == "ä"
