"""Quality of service of topics, as far as ROS users set it."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["LATCHED", "SENSOR", "STATE", "TRANSFORMS", "Qos"]


@dataclass(frozen=True)
class Qos:
    """How the messages of a topic are delivered.

    Attributes:
        reliable: Whether lost messages are sent again; a best-effort writer never matches a reliable reader.
        latched: Whether those who subscribe later get the last messages (``transient_local``).
        depth: Number of messages that are kept (``keep_last``).
    """

    reliable: bool = True
    latched: bool = False
    depth: int = 10


STATE = Qos()
SENSOR = Qos(reliable=False, depth=5)
LATCHED = Qos(latched=True, depth=1)
TRANSFORMS = Qos(depth=100)
