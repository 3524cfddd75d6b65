"""The required form of a client's message, and the answer to a message that lacks it."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Any

import pydantic_core
from mcp.types import INVALID_REQUEST, PARSE_ERROR, JSONRPCMessage, jsonrpc_message_adapter
from pydantic import ValidationError

__all__ = ["MAX_FRAME", "BadFrame", "frame"]

MAX_FRAME = 16 * 1024**2
"""Size of the longest message [bytes]."""
_MAX_SEARCHED = 64 * 1024
"""Number of leading bytes that are searched for the id of a message that is not JSON."""
_TOKEN = re.compile(r'"[^"\\]*(?:\\[\s\S][^"\\]*)*"|"[\s\S]*|[\[\]{}:,]|[^\s"\[\]{}:,]+')


@dataclass(eq=False)
class BadFrame(Exception):
    """A message that is answered with an error.

    Attributes:
        code: Code of JSON-RPC.
        what: Description of the error.
        id: The id of the message, as far as it can be read.
    """

    code: int
    what: str
    id: str | int | None = None

    def answer(self) -> bytes:
        """The answer, as JSON without a line break."""
        error = {"code": self.code, "message": self.what}
        return json.dumps({"jsonrpc": "2.0", "id": self.id, "error": error}).encode()


def frame(data: bytes) -> JSONRPCMessage:
    """Read a message.

    Raises:
        BadFrame: The message is too long, is not JSON, or is not a message of JSON-RPC.
    """
    if len(data) > MAX_FRAME:
        what = f"the message is longer than {MAX_FRAME:,} bytes"
        raise BadFrame(INVALID_REQUEST, what, _searched_id(data))
    try:
        given = pydantic_core.from_json(data, allow_inf_nan=False)
    except ValueError as error:
        raise BadFrame(PARSE_ERROR, f"the message is not JSON: {error}", _searched_id(data)) from None
    if not isinstance(given, dict):
        what = "batches are not read; send each message alone" if isinstance(given, list) else "it must be an object"
        raise BadFrame(INVALID_REQUEST, f"the message is not a request of JSON-RPC 2.0: {what}")
    own = "method" in given or not given.keys() & {"result", "error"}  # an answer has the id of this server's request
    known = given["id"] if own and _is_id(given.get("id")) else None
    if own and "id" in given and known is None:
        what = "the message is not a request of JSON-RPC 2.0: its id must be a text or a whole number"
        raise BadFrame(INVALID_REQUEST, what)
    try:
        return jsonrpc_message_adapter.validate_python(given, by_name=False)
    except ValidationError:
        what = 'it must have "jsonrpc": "2.0", a "method" that is text, and "params" that are an object, if any'
        raise BadFrame(INVALID_REQUEST, f"the message is not a request of JSON-RPC 2.0: {what}", known) from None


def _is_id(value: Any) -> bool:
    return isinstance(value, str | int) and not isinstance(value, bool)


def _searched_id(data: bytes) -> str | int | None:
    """The id at the first level of a message that may not be JSON."""
    tokens = _TOKEN.findall(data[:_MAX_SEARCHED].decode("utf-8", "replace"))
    depth = 0
    for position, token in enumerate(tokens[:-2]):
        if token in ("{", "["):
            depth += 1
        elif token in ("}", "]"):
            depth -= 1
        elif depth == 1 and token == '"id"' and tokens[position + 1] == ":":
            try:
                value = json.loads(tokens[position + 2])
            except ValueError:
                return None
            return value if _is_id(value) else None
    return None
