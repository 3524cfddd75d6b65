"""A stand-in for rosbridge_server, not rosbridge_server: `rosbridge_standin.py PORT [drop|robot]`.

It speaks the operations advertise, publish and subscribe of the protocol rosbridge 2.0 over WebSocket. As the server
does, it knows the definitions of messages and refuses fields that a message does not have; here they are turned into
CDR. It also plays a robot: it sends commands and odometry to those who subscribe. Lines of output: `TOPIC TEXT`.
"""

from __future__ import annotations

import asyncio
import json
import sys
from typing import Any

import numpy as np
from autobahn.asyncio.websocket import WebSocketServerFactory, WebSocketServerProtocol
from rosbags.typesys import Stores, get_typestore

PORT, HOW = int(sys.argv[1]), sys.argv[2:]
STORE = get_typestore(Stores.ROS2_HUMBLE)
TWIST = {"linear": {"x": 0.4, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.5}}
BAD = {"linear": {"x": None, "y": 0.0, "z": 0.0}, "angular": "fast"}


def say(topic: str, text: object) -> None:
    print(topic, text, flush=True)


def built(value: Any, kind: str) -> Any:
    """The message of a JSON object; an error if they do not fit."""
    if kind.startswith("builtin_interfaces"):
        assert set(value) == {"sec", "nanosec"}, value
        return STORE.types[kind](value["sec"], value["nanosec"])
    fields = dict(STORE.fielddefs[kind][1])
    assert set(value) == set(fields), (kind, set(value) ^ set(fields))
    return STORE.types[kind](**{name: member(value[name], form) for name, form in fields.items()})


def member(value: Any, definition: Any) -> Any:
    form, detail = definition
    if form.name == "NAME":
        return built(value, detail)
    if form.name == "BASE":
        return value
    if detail[0][0].name == "NAME":
        return [built(one, detail[0][1]) for one in value]
    return np.array(value, dtype=detail[0][1][0])


class Server(WebSocketServerProtocol):  # type: ignore[misc]
    def onOpen(self) -> None:
        self.kinds: dict[str, str] = {}
        self.count = 0
        if HOW == ["drop"]:  # the first connection breaks
            HOW[:] = ["silent"]
            asyncio.get_running_loop().call_later(1.0, self.dropConnection, True)
            asyncio.get_running_loop().call_later(1.0, say, "dropped", "")

    def onMessage(self, payload: bytes, isBinary: bool) -> None:
        said = json.loads(payload)
        topic = said.get("topic", "")
        if said["op"] == "advertise":
            assert said["type"].count("/") == 2, said["type"]
            self.kinds[topic] = said["type"]
            say("advertise", f"{topic} {said['type']} {said.get('latch', False)}")
        elif said["op"] == "publish":
            message = built(said["msg"], self.kinds[topic])
            cdr = bytes(STORE.serialize_cdr(message, self.kinds[topic]))
            say(topic, f"{len(cdr)} {json.dumps(said['msg'])[:400]}")
        elif said["op"] == "subscribe":
            say("subscribe", f"{topic} {said['type']}")
            if topic.endswith("odom"):
                asyncio.get_running_loop().call_later(0.1, self.odometry, topic)
            if topic.endswith("cmd_vel") and not HOW:
                asyncio.get_running_loop().call_later(0.1, self.command, topic)

    def odometry(self, topic: str) -> None:
        """Say again and again that the robot stands at the origin."""
        if self.state != self.STATE_OPEN:
            return
        time = {"sec": 1, "nanosec": 0}
        pose = {"position": {"x": 0, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
        zero = {"linear": {"x": 0, "y": 0, "z": 0}, "angular": {"x": 0, "y": 0, "z": 0}}
        message = {
            "header": {"stamp": time, "frame_id": "odom"},
            "child_frame_id": "base_link",
            "pose": {"pose": pose, "covariance": [0] * 36},
            "twist": {"twist": zero, "covariance": [0] * 36},
        }
        self.sendMessage(json.dumps({"op": "publish", "topic": topic, "msg": message}).encode())
        asyncio.get_running_loop().call_later(0.02, self.odometry, topic)

    def command(self, topic: str) -> None:
        if self.state != self.STATE_OPEN:
            return
        self.count += 1
        message = BAD if self.count % 20 > 16 else TWIST  # three in a row, so that a step meets one
        self.sendMessage(json.dumps({"op": "publish", "topic": topic, "msg": message}).encode())
        asyncio.get_running_loop().call_later(0.02, self.command, topic)


async def main() -> None:
    factory = WebSocketServerFactory(f"ws://127.0.0.1:{PORT}")
    factory.protocol = Server
    server = await asyncio.get_running_loop().create_server(factory, "127.0.0.1", PORT)
    say("ready", PORT)
    await server.serve_forever()


asyncio.run(main())
