"""``irsim-mcp --log-calls FILE``: a line for each call, from a real client and a real server."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp.types import CallToolResult, TextContent

from irsim_mcp.call_log import CallLog
from tests.mcp.conftest import ROOM, Caller, Wire, as_process, image_of, text_of
from tests.warm import warm

pytestmark = pytest.mark.one_python

KEYS = [
    "call", "at_s", "took_s", "tool", "arguments", "error", "argument_characters", "answer_characters", "pictures",
    "tokens", "codes",
]  # fmt: skip
SECRET = "a-token-that-must-stay-secret"


def logged(path: Path) -> list[dict[str, Any]]:
    text = path.read_text(encoding="utf-8")
    assert not text or text.endswith("\n")
    return [json.loads(line) for line in text.split("\n")[:-1]]


def client_of(workspace: Path, log: Path) -> Caller:
    started = as_process(workspace)
    return Caller(started.model_copy(update={"args": [*started.args, "--log-calls", str(log)]}))


@pytest.mark.anyio
async def test_each_call_is_a_line_with_its_cost(workspace: Path, tmp_path: Path) -> None:
    log = tmp_path / "calls.jsonl"
    async with client_of(workspace, log) as client:
        good = await client.call("validate_scenario", scenario_yaml=ROOM)
        assert len(logged(log)) == 1  # it is there as soon as the answer is
        bad = await client.call("validate_scenario", scenario="é\u2028\n")
        unknown = await client.call("validate")
        drawn = await client.call("render_snapshot", scenario_yaml=ROOM, size_px=300)
    lines = logged(log)
    assert [list(line) for line in lines] == [KEYS] * 4
    assert [line["call"] for line in lines] == [1, 2, 3, 4]
    assert [line["tool"] for line in lines] == ["validate_scenario", "validate_scenario", "validate", "render_snapshot"]
    assert [line["error"] for line in lines] == [False, True, True, False]
    assert [line["codes"] for line in lines] == [[], ["unknown-argument"], ["unknown-tool"], []]
    assert lines[0]["arguments"] == {"scenario_yaml": ROOM}
    assert lines[1]["arguments"] == {"scenario": "é\u2028\n"}
    for line, result in zip(lines, (good, bad, unknown, drawn), strict=True):
        assert line["answer_characters"] == len(text_of(result))
    assert image_of(drawn).mime_type == "image/png"
    [[width, height]] = lines[3]["pictures"]
    assert max(width, height) == 300
    characters = lines[3]["argument_characters"] + lines[3]["answer_characters"]
    assert lines[3]["tokens"] == math.ceil(characters / 4 + width * height / 750)
    times = [line["at_s"] for line in lines]
    assert times == sorted(times)
    assert all(0 <= line["took_s"] < 60 for line in lines)


@pytest.mark.anyio
async def test_calls_at_the_same_time_do_not_mix(workspace: Path, tmp_path: Path) -> None:
    log = tmp_path / "calls.jsonl"
    topics = [f"no-such-topic-{number}" for number in range(8)]
    async with client_of(workspace, log) as client, anyio.create_task_group() as group:
        for topic in topics:
            group.start_soon(client.call_tool, "lookup", {"topic": topic})
    lines = logged(log)
    assert sorted(line["call"] for line in lines) == list(range(1, 9))
    assert sorted(line["arguments"]["topic"] for line in lines) == sorted(topics)


def test_a_killed_server_has_lost_nothing_and_the_next_one_goes_on(workspace: Path, tmp_path: Path) -> None:
    log = tmp_path / "calls.jsonl"
    log.write_text('{"call": 1, "tool": "lookup", "argum', encoding="utf-8")  # a line that was cut off
    for _ in range(2):
        wire = Wire(
            workspace, "--log-calls", str(log), stderr=subprocess.PIPE, env={**os.environ, "IRSIM_MCP_TOKEN": SECRET}
        )
        wire.call("lookup", topik="dash")  # which is refused at once
        assert wire.receive()["id"] == 2
        wire.process.kill()
        assert wire.process.communicate() == ("", "")
    torn, *lines = log.read_text(encoding="utf-8").splitlines()
    assert torn.endswith("argum")
    assert [json.loads(line)["tool"] for line in lines] == ["lookup", "lookup"]
    assert SECRET not in log.read_text(encoding="utf-8")


@pytest.mark.parametrize("where", ["folder", "missing/calls.jsonl", "pipe", "/dev/stdout"])
@pytest.mark.skipif(os.name == "nt", reason="makes a named pipe")
def test_a_file_that_cannot_be_written_is_refused_at_the_start(workspace: Path, tmp_path: Path, where: str) -> None:
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    with (tmp_path / "out").open("w+") as out:  # /dev/stdout is then an ordinary file, but not one to write to
        command = warm([sys.executable, "-m", "irsim_mcp", "--workspace", str(workspace), "--log-calls", where])
        done = subprocess.run(
            command, cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE, text=True, check=False
        )
        out.seek(0)
        assert out.read() == ""
    assert done.returncode == 2
    assert f"--log-calls: {where} " in done.stderr
    assert "choose a file of your own" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="writes to a disk that is always full")
def test_a_full_disk_is_said_once_and_ends_no_call(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = CallLog(tmp_path / "calls.jsonl")
    answer = CallToolResult(content=[TextContent(type="text", text="four")])
    with open("/dev/full", "wb") as full:
        os.dup2(full.fileno(), log._file)
    for _ in range(3):
        log.record("lookup", {}, answer, log.now())
    assert capsys.readouterr().err.count("--log-calls: No space left on device") == 1


def test_arguments_that_are_too_long_or_no_json_do_not_end_a_call(tmp_path: Path) -> None:
    log = CallLog(tmp_path / "calls.jsonl")
    deep: Any = []
    for _ in range(100_000):
        deep = [deep]
    for arguments in ({"text": "x" * 600_000}, {"deep": deep}, {"lone": "\ud800"}):
        log.record("lookup", arguments, ValueError("refused"), log.now())
    lines = logged(tmp_path / "calls.jsonl")
    assert [line["arguments"] for line in lines] == [None, None, {"lone": "\ud800"}]
    assert lines[0]["tokens"] > 150_000
    assert all(line["error"] and line["answer_characters"] == 7 for line in lines)
