"""Input that is not a message: both transports answer it with an error, and nothing ends or waits for ever."""

from __future__ import annotations

import json
import os
import random
import subprocess
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import anyio
import httpx2
import pytest
from starlette.responses import PlainTextResponse

from irsim_mcp.bodies import WholeMessages
from irsim_mcp.frames import MAX_FRAME, BadFrame, frame
from tests.mcp.conftest import HANDSHAKE
from tests.mcp.test_http import HEADERS, served
from tests.warm import warm_mcp

pytestmark = pytest.mark.one_python

PING = b'{"jsonrpc":"2.0","id":7,"method":"ping"'
PARSE, INVALID = -32700, -32600

BAD: dict[str, tuple[bytes, int, Any]] = {
    "half a surrogate pair": (PING + rb',"params":{"a":"\ud800"}}', PARSE, 7),
    "the other half": (PING + rb',"params":{"a":"\udfff x"}}', PARSE, 7),
    "half a pair as a key": (PING + rb',"params":{"\ud800":1}}', PARSE, 7),
    "half a pair as an id": (rb'{"jsonrpc":"2.0","id":"\ud800","method":"ping"}', PARSE, "\ud800"),
    "a number of 5,000 digits": (PING + b',"params":{"a":' + b"9" * 5000 + b"}}", PARSE, 7),
    "a number of 5,000 digits after a point": (PING + b',"params":{"a":0.' + b"9" * 5000 + b"x}}", PARSE, 7),
    "an id of 5,000 digits": (b'{"jsonrpc":"2.0","id":' + b"9" * 5000 + b',"method":"ping"}', PARSE, None),
    "3,000 levels": (PING + b',"params":{"a":' + b"[" * 3000 + b"]" * 3000 + b"}}", PARSE, 7),
    "3,000 levels before the id": (b'{"params":' + b'{"a":' * 3000 + b"1" + b"}" * 3000 + b',"id":7}', PARSE, 7),
    "100,000 brackets": (b"[" * 100_000, PARSE, None),
    "no JSON": (b"not a message", PARSE, None),
    "a cut message": (PING, PARSE, 7),
    "a cut text": (PING + b',"params":{"a":"b', PARSE, 7),
    "an id that is inside only": (b'{"a":{"id":5},"b":', PARSE, None),
    "an id that is in a text": (b'{"a":"\\"id\\":5,","b":', PARSE, None),
    "two messages in a line": (PING + b"}" + PING + b"}", PARSE, 7),
    "single quotes": (b"{'jsonrpc':'2.0','id':7}", PARSE, None),
    "a comma at the end": (PING + b",}", PARSE, 7),
    "a comment": (b"// a\t" + PING + b"}", PARSE, 7),
    "NaN": (PING + b',"params":{"a":NaN}}', PARSE, 7),
    "Infinity": (PING + b',"params":{"a":-Infinity}}', PARSE, 7),
    "a BOM": (b"\xef\xbb\xbf" + PING + b"}", PARSE, 7),
    "a BOM of UTF-16": ((PING + b"}").decode().encode("utf-16-be"), PARSE, None),
    "invalid UTF-8": (PING + b',"params":{"a":"\xff\xfe"}}', PARSE, 7),
    "a surrogate in UTF-8": (PING + b',"params":{"a":"\xed\xa0\x80"}}', PARSE, 7),
    "a control character": (PING + b',"params":{"a":"\x01"}}', PARSE, 7),
    "NUL": (b"\0" + PING + b"}", PARSE, 7),
    "an id 1.5": (b'{"jsonrpc":"2.0","id":1.5,"method":"ping"}', INVALID, None),
    "an id that is null": (b'{"jsonrpc":"2.0","id":null,"method":"ping"}', INVALID, None),
    "an id that is true": (b'{"jsonrpc":"2.0","id":true,"method":"ping"}', INVALID, None),
    "an id that is a list": (b'{"jsonrpc":"2.0","id":[7],"method":"ping"}', INVALID, None),
    "a batch": (b"[" + PING + b"}]", INVALID, None),
    "an empty batch": (b"[]", INVALID, None),
    "a number": (b"7", INVALID, None),
    "a text": (b'"ping"', INVALID, None),
    "null": (b"null", INVALID, None),
    "an empty object": (b"{}", INVALID, None),
    "no method": (b'{"jsonrpc":"2.0","id":7}', INVALID, 7),
    "a method that is a number": (b'{"jsonrpc":"2.0","id":7,"method":1}', INVALID, 7),
    "no version": (b'{"id":7,"method":"ping"}', INVALID, 7),
    "version 1.0": (b'{"jsonrpc":"1.0","id":"a","method":"ping"}', INVALID, "a"),
    "a list of parameters": (PING + b',"params":[1]}', INVALID, 7),
    "a notification with a list of parameters": (b'{"jsonrpc":"2.0","method":"x","params":[1]}', INVALID, None),
    "a result without a meaning": (b'{"jsonrpc":"2.0","id":7,"result":3}', INVALID, None),
}


def asked(process: subprocess.Popen[bytes], *lines: bytes) -> list[dict[str, Any]]:
    """The answers of a server to these lines, each of which has one."""
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(b"".join(line + b"\n" for line in lines))
    process.stdin.flush()
    return [json.loads(process.stdout.readline()) for _ in lines]


def request(number: object, method: str = "ping", **params: Any) -> bytes:
    return json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}).encode()


@pytest.fixture
def started(empty: Path) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        warm_mcp("--workspace", str(empty)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=-1
    )
    with process:
        asked(process, request(1, "initialize", **HANDSHAKE))
        yield process
        process.kill()


def check(answer: dict[str, Any], code: int, known: object) -> None:
    assert (answer["error"]["code"], answer["id"]) == (code, known), answer
    assert len(answer["error"]["message"]) < 300


def test_every_one_is_answered_over_stdio(started: subprocess.Popen[bytes]) -> None:
    for name, (line, code, known) in BAD.items():
        (answer,) = asked(started, line)
        assert "error" in answer, name
        check(answer, code, known)
    assert asked(started, request(8))[0]["result"] is not None


def test_every_one_is_answered_over_http(empty: Path) -> None:
    with served(empty, "--http", "0") as (url, _), httpx2.Client() as client:
        first = client.post(url, content=request(1, "initialize", **HANDSHAKE), headers=HEADERS)
        session = {"Mcp-Session-Id": first.headers["mcp-session-id"], "Mcp-Protocol-Version": "2025-06-18"}
        for headers in (HEADERS, HEADERS | session, HEADERS | {"Mcp-Protocol-Version": "2026-07-28"}):
            for name, (line, code, known) in BAD.items():
                answer = client.post(url, content=line, headers=headers)
                assert answer.status_code == 400, name
                check(answer.json(), code, known)
        assert client.post(url, content=request(8), headers=HEADERS | session).status_code == 200


@pytest.mark.anyio
async def test_an_id_in_use_is_refused_over_http() -> None:
    answered = anyio.Event()

    async def app(scope: Any, receive: Any, send: Any) -> None:
        await answered.wait()
        await PlainTextResponse("answer")(scope, receive, send)

    statuses: dict[str, list[int]] = {"a": [], "b": []}
    transport = httpx2.ASGITransport(app=WholeMessages(app))
    async with httpx2.AsyncClient(transport=transport) as client, anyio.create_task_group() as tasks:

        async def ask(session: str, number: object) -> None:
            answer = await client.post("http://x/", content=request(number), headers={"Mcp-Session-Id": session})
            statuses[session].append(answer.status_code)

        for session, number in (("a", 5), ("a", "5"), ("b", 5), ("a", 6)):  # the SDK takes 5 and "5" for the same
            tasks.start_soon(ask, session, number)
        await anyio.wait_all_tasks_blocked()
        assert statuses == {"a": [400], "b": []}
        answered.set()
    assert statuses == {"a": [400, 200, 200], "b": [200]}


DAMAGED = [
    request(7, "tools/call", name="lookup", arguments={"topic": 'é \U0001f600 "id": 3'}),
    b'{"id":"a","params":{"x":[1,-2.5e3,null,true,{"id":4}]},"method":"ping","jsonrpc":"2.0"}',
    b'{"jsonrpc":"2.0","id":3,"error":{"code":-1,"message":"no"}}',
]


@pytest.mark.parametrize("seed", range(10))
def test_damaged_messages_are_read_or_refused(seed: int) -> None:
    rng = random.Random(seed)
    for text in DAMAGED * 20:
        data = bytearray(text)
        for _ in range(rng.randint(1, 4)):
            place = rng.randrange(len(data))
            data[place : place + rng.randint(0, 3)] = rng.choice(
                [
                    b"",
                    b"\xff",
                    b"\0",
                    b"[",
                    b"}",
                    b'"',
                    b"\\",
                    b"\\ud83d",
                    b"9" * 400,
                    b"id",
                    bytes([rng.randrange(256)]),
                ]
            )
        with suppress(BadFrame):
            assert frame(bytes(data)).jsonrpc == "2.0"
            continue
        with pytest.raises(BadFrame) as bad:
            frame(bytes(data))
        answer = json.loads(bad.value.answer())
        assert answer["error"]["code"] in (PARSE, INVALID)
        assert isinstance(answer["id"], str | int | None)
        assert b"\n" not in bad.value.answer()


def test_a_long_line_is_refused_and_the_next_one_read(started: subprocess.Popen[bytes]) -> None:
    long = PING + b',"params":{"a":"' + b"x" * (MAX_FRAME + 10) + b'"}}'
    answers = asked(started, long, request(8))
    check(answers[0], INVALID, 7)
    assert answers[1]["id"] == 8


def test_a_message_that_is_just_not_too_long_is_read() -> None:
    rest = b',"params":{"a":"%b"}}'
    text = PING + rest % (b"x" * (MAX_FRAME - len(PING) - len(rest) + 2))
    assert len(text) == MAX_FRAME
    assert frame(text).id == 7  # type: ignore[union-attr]
    with pytest.raises(BadFrame, match="longer than"):
        frame(text + b" ")


def test_an_id_in_use_is_refused(started: subprocess.Popen[bytes]) -> None:
    lookup = {"name": "lookup", "arguments": {"topic": "crossing"}}
    answers = asked(started, request("a", "tools/call", **lookup), request("a"))
    check(answers[0], INVALID, "a")
    assert answers[1]["id"] == "a"
    assert "result" in answers[1]
    assert asked(started, request("a"))[0]["result"] is not None  # now it is free


def test_blank_lines_are_no_messages(started: subprocess.Popen[bytes]) -> None:
    assert started.stdin is not None
    started.stdin.write(b"\n  \r\n\n")
    assert asked(started, request(9))[0]["id"] == 9


def test_requests_before_the_end_of_input_are_answered(started: subprocess.Popen[bytes]) -> None:
    assert started.stdin is not None
    assert started.stdout is not None
    lines = [request(number, ("ping", "tools/list", "prompts/list")[number % 3]) for number in range(100, 250)]
    lines += [line for line, *_ in BAD.values()] + [request(99)]  # the last one without a line break
    started.stdin.write(b"\n".join(lines))
    started.stdin.close()
    answers = [json.loads(line) for line in started.stdout.read().splitlines()]
    assert len(answers) == len(lines)
    assert {*range(100, 250), 99} <= {answer["id"] for answer in answers if "result" in answer}
    assert started.wait(10) == 0


def test_a_client_that_never_reads_does_not_keep_the_server_alive(empty: Path) -> None:
    mine, theirs = os.pipe()
    process = subprocess.Popen(warm_mcp("--workspace", str(empty)), stdin=subprocess.PIPE, stdout=theirs, bufsize=-1)
    os.close(theirs)
    try:
        assert process.stdin is not None
        process.stdin.write(request(1, "initialize", **HANDSHAKE) + b"\n")
        for number in range(2, 60):  # more than a pipe holds
            process.stdin.write(request(number, "tools/list") + b"\n" + b"no message\n")
        process.stdin.flush()
        time.sleep(0.5)
        assert process.poll() is None
        process.stdin.close()
        assert process.wait(20) == 0
    finally:
        process.kill()
        process.wait()
        os.close(mine)
