"""A server of the rosbridge protocol on a real ROS 1, not rosbridge_server: `rosbridge_on_rospy.py PORT`.

Publications of clients become messages of rospy, which go to a real master and real subscribers; publications of other
nodes go to the clients that have subscribed. Operations: advertise, unadvertise, publish, subscribe, unsubscribe,
set_level. As the protocol has it, what is wrong is told to the client with the operation status. Lines of
output: `ready PORT`, `client NUMBER`, `gone NUMBER`, `advertise TOPIC TYPE`, `publish TOPIC`, `error TEXT`.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import sys
from collections.abc import Callable
from typing import Any

from autobahn.asyncio.websocket import WebSocketServerFactory, WebSocketServerProtocol

sys.path.append("/usr/lib/python3/dist-packages")
sys.path.append(__file__.rpartition("/")[0])
import rospy
from ros_json import as_json, message_class, message_of

PORT = int(sys.argv[1])
NUMBERS = itertools.count(1)


def say(topic: str, text: object) -> None:
    sys.stdout.write(f"{topic} {text}\n")
    sys.stdout.flush()


class Server(WebSocketServerProtocol):  # type: ignore[misc]
    """The connection of one client."""

    def onOpen(self) -> None:
        self.number = next(NUMBERS)
        self.loop = asyncio.get_running_loop()
        self.publishers: dict[str, tuple[Any, Any]] = {}
        self.subscribers: dict[str, Any] = {}
        self.operations: dict[str, Callable[[dict[str, Any]], None]] = {
            "advertise": self.advertise,
            "unadvertise": self.unadvertise,
            "publish": self.publish,
            "subscribe": self.subscribe,
            "unsubscribe": self.unsubscribe,
            "set_level": lambda said: None,
        }
        say("client", self.number)

    def onMessage(self, payload: bytes, isBinary: bool) -> None:
        said: dict[str, Any] = {}
        try:
            said = json.loads(payload)
            self.operations[said["op"]](said)
        except Exception as error:
            text = f"{said.get('op')} {said.get('topic', '')}: {type(error).__name__}: {error}"
            say("error", text)
            self.send({"op": "status", "level": "error", "id": said.get("id"), "msg": text})

    def onClose(self, wasClean: bool, code: int | None, reason: str | None) -> None:
        if hasattr(self, "number"):
            for publisher, _ in self.publishers.values():
                publisher.unregister()
            for subscriber in self.subscribers.values():
                subscriber.unregister()
            say("gone", self.number)

    def advertise(self, said: dict[str, Any]) -> None:
        topic, kind = said["topic"], said["type"]
        options = {"queue_size": said.get("queue_size", 100), "latch": said.get("latch", False)}
        made = message_class(kind)
        self.publishers[topic] = rospy.Publisher(topic, made, **options), made
        say("advertise", f"{topic} {kind}")

    def unadvertise(self, said: dict[str, Any]) -> None:
        self.publishers.pop(said["topic"])[0].unregister()

    def publish(self, said: dict[str, Any]) -> None:
        publisher, made = self.publishers[said["topic"]]
        publisher.publish(message_of(said["msg"], made))
        say("publish", said["topic"])

    def subscribe(self, said: dict[str, Any]) -> None:
        topic = said["topic"]

        def heard(message: Any) -> None:  # in a thread of rospy
            content = {"op": "publish", "topic": topic, "msg": as_json(message)}
            self.loop.call_soon_threadsafe(self.send, content)

        self.subscribers[topic] = rospy.Subscriber(topic, message_class(said["type"]), heard)

    def unsubscribe(self, said: dict[str, Any]) -> None:
        self.subscribers.pop(said["topic"]).unregister()

    def send(self, content: dict[str, Any]) -> None:
        if self.state == self.STATE_OPEN:
            self.sendMessage(json.dumps(content, allow_nan=False).encode())


async def main() -> None:
    factory = WebSocketServerFactory(f"ws://127.0.0.1:{PORT}")
    factory.protocol = Server
    server = await asyncio.get_running_loop().create_server(factory, "127.0.0.1", PORT)
    say("ready", PORT)
    await server.serve_forever()


rospy.init_node("rosbridge_websocket", disable_signals=True)
asyncio.run(main())
