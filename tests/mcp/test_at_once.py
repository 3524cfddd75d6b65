"""Equal questions at the same time: one process answers them all, also with an error, and no client waits for ever."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp.server.mcpserver.exceptions import ToolError

from irsim_mcp.once import Once
from irsim_mcp.server import build_server
from irsim_mcp.worker import Workers
from tests.mcp.conftest import Caller

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The tasks of the processes that were started."""
    tasks: list[str] = []
    work = Workers._work

    async def counted(self: Workers, job: dict[str, Any], *rest: Any) -> dict[str, Any]:
        tasks.append(job["task"])
        return await work(self, job, *rest)

    monkeypatch.setattr(Workers, "_work", counted)
    return tasks


async def test_two_hundred_equal_lookups_start_one_process(empty: Path, started: list[str]) -> None:
    answers: list[str] = []
    async with Caller(build_server(empty)) as client, anyio.create_task_group() as tasks:

        async def ask() -> None:
            answers.append(await client.text("lookup", topic="crossing"))

        for _ in range(200):
            tasks.start_soon(ask)
    assert started == ["lookup"]
    assert len(answers) == 200
    assert set(answers) == {answers[0]}


async def test_an_error_of_equal_questions_is_found_once(empty: Path, started: list[str]) -> None:
    told: list[str] = []
    async with Caller(build_server(empty)) as client, anyio.create_task_group() as tasks:

        async def ask() -> None:
            told.append(await client.error("lookup", topic="crossing", parameters={"no_such_key": 1}))

        for _ in range(20):
            tasks.start_soon(ask)
    assert started == ["lookup"]
    assert len(told) == 20
    assert set(told) == {told[0]}


async def test_who_is_cancelled_leaves_the_question_to_the_next() -> None:
    once, asked, heard = Once[str](), list[int](), list[str]()

    async def ask(number: int, scope: anyio.CancelScope) -> None:
        async def work() -> str:
            asked.append(number)
            await anyio.sleep(10 if number == 0 else 0)
            return f"from {number}"

        with scope:
            heard.append(await once.get("question", work))

    scopes = [anyio.CancelScope() for _ in range(3)]
    async with anyio.create_task_group() as tasks:
        for number, scope in enumerate(scopes):
            tasks.start_soon(ask, number, scope)
        await anyio.wait_all_tasks_blocked()
        scopes[0].cancel()
    assert asked == [0, 1]
    assert heard == ["from 1", "from 1"]


async def test_errors_are_not_kept() -> None:
    once, tries = Once[int](), list[int]()

    async def work() -> int:
        tries.append(1)
        if len(tries) == 1:
            raise ToolError("busy: again")
        return 7

    with pytest.raises(ToolError, match="again"):
        await once.get("question", work)
    assert [await once.get("question", work), await once.get("question", work)] == [7, 7]
    assert len(tries) == 2
