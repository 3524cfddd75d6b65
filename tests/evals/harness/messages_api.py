"""A stand-in of Anthropic's Messages API on the loopback address: scripted answers, streamed or whole, and faults."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any


@dataclass
class Reply:
    """An answer of the model.

    Attributes:
        text: Its text.
        calls: Tools that it calls: name and arguments.
        usage: Tokens.
        stop_reason: Why it stops; default: to have tools called, or because it is done.
        cut_after: Number of events after which the stream is cut.
    """

    text: str = ""
    calls: list[tuple[str, dict[str, Any]]] = field(default_factory=list)
    usage: dict[str, int] = field(default_factory=lambda: {"input_tokens": 1000, "output_tokens": 100})
    stop_reason: str | None = None
    cut_after: int | None = None


@dataclass
class Fault:
    """An error of the service."""

    status: int
    kind: str
    message: str
    headers: dict[str, str] = field(default_factory=dict)


Script = Callable[[dict[str, Any]], "Reply | Fault"]
"""From the body of a request to what is answered."""


def follow(*replies: Reply | Script) -> Script:
    """A script of one answer for each turn, the last one for all further turns."""

    def script(body: dict[str, Any]) -> Reply | Fault:
        reply = replies[min(turn_of(body), len(replies) - 1)]
        return reply if isinstance(reply, Reply) else reply(body)

    return script


def said(body: dict[str, Any]) -> str:
    """Text of the answers of tools in the last message of a request."""
    contents = [result["content"] for result in results_in(body)]
    parts = [part for content in contents for part in ([{"text": content}] if isinstance(content, str) else content)]
    return "\n".join(part.get("text", "") for part in parts)


class MessagesApi:
    """The running stand-in.

    Attributes:
        url: Its address.
        requests: Bodies of the requests, in their order.
        headers: Headers of the requests.
        faults: Answers to the next requests; the script answers the ones after them.
    """

    def __init__(self, url: str, script: Script) -> None:
        self.url, self.script = url, script
        self.requests: list[dict[str, Any]] = []
        self.headers: list[dict[str, str]] = []
        self.faults: list[Fault | Reply] = []
        self.lock = threading.Lock()

    def answer(self, body: dict[str, Any], headers: dict[str, str]) -> Reply | Fault:
        with self.lock:
            self.requests.append(body)
            self.headers.append(headers)
            if self.faults:
                return self.faults.pop(0)
        try:
            return self.script(body)
        except Exception as error:  # a request that the script did not expect ends the attempt at once
            return Fault(400, "invalid_request_error", f"{type(error).__name__}, {error}")


@contextmanager
def messages_api(script: Script) -> Iterator[MessagesApi]:
    """Serve on a free port of the loopback address."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Handler)
    server.daemon_threads = True
    server.api = MessagesApi(f"http://127.0.0.1:{server.server_address[1]}", script)  # type: ignore[attr-defined]
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True)
    thread.start()
    try:
        yield server.api  # type: ignore[attr-defined]
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def turn_of(body: dict[str, Any]) -> int:
    """Number of answers that the model has given in the conversation of a request."""
    return sum(message["role"] == "assistant" for message in body["messages"])


def results_in(body: dict[str, Any]) -> list[dict[str, Any]]:
    """Answers of the tools that the last message of a request brings."""
    content = body["messages"][-1]["content"]
    return [block for block in content if block["type"] == "tool_result"] if isinstance(content, list) else []


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_: Any) -> None:
        pass

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["content-length"])))
        if self.path.partition("?")[0] != "/v1/messages":
            return self._json(404, {"type": "error", "error": {"type": "not_found_error", "message": self.path}})
        answer = self.server.api.answer(body, {k.lower(): v for k, v in self.headers.items()})  # type: ignore[attr-defined]
        if isinstance(answer, Fault):
            error = {"type": "error", "error": {"type": answer.kind, "message": answer.message}}
            return self._json(answer.status, error, answer.headers)
        message = _message(answer, body["model"], turn_of(body))
        if not body.get("stream"):
            return self._json(200, message)
        return self._stream(message, answer.cut_after)

    def _json(self, status: int, data: dict[str, Any], headers: dict[str, str] | None = None) -> None:
        content = json.dumps(data).encode()
        self.send_response(status)
        for name, value in {"content-type": "application/json", **(headers or {})}.items():
            self.send_header(name, value)
        self.send_header("content-length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def _stream(self, message: dict[str, Any], cut_after: int | None) -> None:
        self.send_response(200)
        self.send_header("content-type", "text/event-stream")
        self.send_header("transfer-encoding", "chunked")
        self.end_headers()
        for number, event in enumerate(_events(message)):
            if number == cut_after:
                self.close_connection = True
                return
            data = f"event: {event['type']}\ndata: {json.dumps(event)}\n\n".encode()
            self.wfile.write(f"{len(data):x}\r\n".encode() + data + b"\r\n")
        self.wfile.write(b"0\r\n\r\n")


def _message(reply: Reply, model: str, turn: int) -> dict[str, Any]:
    blocks: list[dict[str, Any]] = [{"type": "text", "text": reply.text}] if reply.text else []
    for number, (name, arguments) in enumerate(reply.calls):
        blocks.append({"type": "tool_use", "id": f"toolu_{turn}_{number}", "name": name, "input": arguments})
    return {
        "id": f"msg_{turn}", "type": "message", "role": "assistant", "model": model, "content": blocks,
        "stop_reason": reply.stop_reason or ("tool_use" if reply.calls else "end_turn"), "stop_sequence": None,
        "usage": reply.usage,
    }  # fmt: skip


def _events(message: dict[str, Any]) -> Iterator[dict[str, Any]]:
    yield {"type": "message_start", "message": {**message, "content": [], "stop_reason": None}}
    for index, block in enumerate(message["content"]):
        if block["type"] == "text":
            yield {"type": "content_block_start", "index": index, "content_block": {"type": "text", "text": ""}}
            delta = {"type": "text_delta", "text": block["text"]}
            yield {"type": "content_block_delta", "index": index, "delta": delta}
        else:
            yield {"type": "content_block_start", "index": index, "content_block": {**block, "input": {}}}
            text = json.dumps(block["input"])
            for part in (text[: len(text) // 2], text[len(text) // 2 :]):
                delta = {"type": "input_json_delta", "partial_json": part}
                yield {"type": "content_block_delta", "index": index, "delta": delta}
        yield {"type": "content_block_stop", "index": index}
    stop = {"stop_reason": message["stop_reason"], "stop_sequence": None}
    yield {"type": "message_delta", "delta": stop, "usage": message["usage"]}
    yield {"type": "message_stop"}
