"""Recorded calls of agents, and questions with one answer, against a server of today."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from mcp import Client
from mcp.types import TextContent

from irsim_evals.cases.store import all_case_ids, case_of
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_mcp.server import build_server
from tests.evals.conftest import EVALS

pytestmark = pytest.mark.anyio

TRANSCRIPTS = sorted((EVALS / "transcripts").glob("*.jsonl"))
QUESTIONS: list[dict[str, Any]] = json.loads((EVALS / "questions.json").read_text(encoding="utf-8"))


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


class Caller:
    """Calls tools; `$run2` in arguments is the second run that they made."""

    def __init__(self, client: Client) -> None:
        self.client = client
        self.runs: list[str] = []

    async def __call__(self, tool: str, arguments: dict[str, Any]) -> tuple[str, bool]:
        known = {f"$run{i}": run for i, run in enumerate(self.runs, 1)}
        filled = {key: known.get(value, value) if isinstance(value, str) else value for key, value in arguments.items()}
        result = await self.client.call_tool(tool, filled)
        first = result.content[0]
        assert isinstance(first, TextContent)
        if tool == "run_episode" and not result.is_error:
            assert result.structured_content is not None
            self.runs.append(result.structured_content["run_id"])
        return first.text, bool(result.is_error)


def lines(path: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The case and the files that make up the answer, and what was done."""
    first, *rest = (json.loads(line) for line in path.read_text(encoding="utf-8").splitlines())
    return first, rest


@pytest.mark.slow(8)
@pytest.mark.parametrize("path", TRANSCRIPTS, ids=lambda path: path.stem)
async def test_a_transcript_still_leads_to_its_end(path: Path, tmp_path: Path) -> None:
    asked, steps = lines(path)
    workspace = tmp_path / "workspace"
    workspace.mkdir()
    for name, text in case_of(asked["case"]).case.files.items():
        (workspace / name).write_text(text, encoding="utf-8")
    wrong = []  # told after the client is closed, which would wrap it
    async with Client(build_server(workspace)) as client:
        call = Caller(client)
        for step in steps:
            if "file" in step:
                (workspace / step["file"]).write_text(step["text"], encoding="utf-8")
                continue
            text, failed = await call(step["tool"], step["arguments"])
            if failed or not all(expected in text for expected in step["expect"]):
                wrong.append({**step, "text": text})
    assert wrong == []
    assert {name: (workspace / name).read_text(encoding="utf-8") for name in asked["answer"]} == answer_of(path)


def answer_of(path: Path) -> dict[str, str]:
    """Name → last text of each file of the answer."""
    asked, steps = lines(path)
    last = {step["file"]: step["text"] for step in steps if "file" in step}
    return {name: last[name] for name in asked["answer"]}


@pytest.mark.parametrize("path", TRANSCRIPTS, ids=lambda path: path.stem)
def test_the_answer_of_a_transcript_passes_its_case(path: Path) -> None:
    verdict = grade(case_of(lines(path)[0]["case"]), Answer(path.stem, answer_of(path)))
    assert [(one.assertion, one.expected, one.observed) for one in verdict.failed()] == []
    assert verdict.strict


def test_transcripts_are_varied_and_well_formed() -> None:
    assert len(TRANSCRIPTS) >= 6
    tools: set[str] = set()
    for path in TRANSCRIPTS:
        asked, steps = lines(path)
        assert set(asked) == {"case", "answer"}
        assert asked["case"] in all_case_ids()
        assert all(set(step) in ({"file", "text"}, {"tool", "arguments", "expect"}) for step in steps)
        assert all(step["expect"] for step in steps if "tool" in step)
        tools |= {step["tool"] for step in steps if "tool" in step}
    assert tools == {"lookup", "validate_scenario", "render_snapshot", "run_episode", "inspect_run", "benchmark"}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("questions")


@pytest.mark.parametrize("item", QUESTIONS, ids=lambda item: item["id"])
async def test_the_tools_know_the_answer(item: dict[str, Any], shared: Path) -> None:
    assert set(item) == {"id", "question", "answer", "calls", "found"}
    async with Client(build_server(shared)) as client:
        call = Caller(client)
        for step in item["calls"]:
            text, _ = await call(step["tool"], step["arguments"])
    match = re.search(item["found"], text)
    assert match, text
    assert ", ".join(match.groups()) == item["answer"]


def test_there_are_ten_questions() -> None:
    assert len({item["id"] for item in QUESTIONS}) == len(QUESTIONS) == 10
