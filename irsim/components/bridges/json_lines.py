"""``json_lines``: any program that reads and writes lines of JSON over a local or remote socket."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.options import BridgeOptions, opened_by
from irsim.options.base import problem
from irsim.options.registry import BRIDGES
from irsim.options.units import Bool, Seconds


class JsonLines(BridgeOptions):
    """Connect to a program that listens on a TCP port: it gets the scene and every state as one line of JSON each.

    The program may answer with lines that have goals, commands, or the poses of objects that it moves itself.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "json_lines", "address": "127.0.0.1:9100"}]}

    objects: ClassVar[tuple[str, ...]] = ("agents",)

    name: Literal["json_lines"] = "json_lines"
    address: str = "127.0.0.1:9100"
    """Where the program listens, `host:port`."""
    agents: list[str] = []
    """Names of the objects that the program moves; irsim moves the others."""
    answers: Bool = False
    """Whether the program answers each message with one line, for which irsim waits. It has to if it moves objects, or
    with `clock: external`."""
    timeout: Annotated[Seconds, Field(gt=0, le=3600)] = 5.0
    """Time for which irsim waits for a connection and for each answer."""

    def driven(self, robots: Sequence[str]) -> Sequence[str]:
        """All of them."""
        return robots

    def model_post_init(self, context: Any) -> None:
        """Check what keys mean together."""
        host, colon, port = self.address.rpartition(":")
        if not host or not colon or not port.isdigit() or not 0 < int(port) < 65536:
            raise problem(
                "invalid-value", f"address must be host:port, got {self.address!r}", fix="address: 127.0.0.1:9100"
            )
        if (self.agents or self.clock == "external") and not self.answers:
            raise problem("invalid-value", "a program that moves objects or decides about steps answers each message",
                          fix="answers: true")  # fmt: skip


BRIDGES.register(JsonLines)(opened_by("json_lines"))
