"""Two nodes in this process, of which one must hear the other."""

from __future__ import annotations

import time
from contextlib import ExitStack, closing
from dataclasses import replace

from irsim.bridges.ros.backends.opening import make_messages, open_backend
from irsim.bridges.ros.inbox import Inbox
from irsim.bridges.ros.incoming import decode, read_twist
from irsim.bridges.ros.qos import STATE
from irsim.bridges.ros.topics import Topic
from irsim.components.bridges.ros2 import Ros2

__all__ = ["two_nodes"]

_WAIT_S = 10.0
_TWIST = Topic("cmd_vel", "/irsim_doctor/cmd_vel", "geometry_msgs/msg/Twist", True, STATE)


def two_nodes(first: Ros2, second: Ros2) -> str:
    """Send a command from one node to another one.

    Returns:
        A sentence about it.

    Raises:
        TimeoutError: It did not come.
    """
    messages, inbox, heard = make_messages(first), Inbox(), replace(_TWIST, outgoing=False)
    with ExitStack() as nodes:
        sender = nodes.enter_context(closing(open_backend(first, "irsim_doctor", [_TWIST], Inbox(), messages)))
        receiver = nodes.enter_context(closing(open_backend(second, "irsim_doctor_too", [heard], inbox, messages)))
        began = time.monotonic()
        while time.monotonic() - began < _WAIT_S:
            sender.publish(_TWIST, messages.twist(0.5, 0.0, 1.0))
            time.sleep(0.02)
            receiver.poll()
            for topic, arrival in inbox.take().items():
                if read_twist(decode(messages, topic, arrival.content)) == (0.5, 0.0, 1.0):
                    return f"a command went from a node to another one after {time.monotonic() - began:.1f} s"
    raise TimeoutError(f"a node did not hear another one on this computer within {_WAIT_S:g} s")
