"""Types that we make for Cyclone DDS from the definitions: they read and write the very bytes of rosbags."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from irsim.bridges.ros.backends.dds import dds_type_name, struct_type
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.outgoing import Outgoing
from irsim.bridges.ros.topics import TABLE, scene_topics
from irsim.bridges.state import world_state
from irsim.objects.describe import agent_rows, describe_scene
from tests.interop.ros.conftest import SCENE

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("ros_others")]


def test_all_messages_of_a_scene_have_equal_bytes(make_env: Callable[[str], Any]) -> None:
    env = make_env(SCENE)
    for _ in range(3):
        env.step()
    scene = describe_scene(env.simulation)
    state = world_state(env.simulation, agent_rows(env.simulation))
    messages = Messages()
    topics = scene_topics(scene, scene.robots, "sim", names={}, qos={})
    outgoing = Outgoing(messages, scene, topics, "map", "sim")
    seen = set()
    for topic, message in [*outgoing.once(5), *outgoing.step(state)]:
        made = struct_type(messages.store, topic.kind)
        ours = messages.cdr(message, topic.kind)
        theirs = made.deserialize(ours).serialize(use_version_2=False)
        # the header may say how many bytes of padding follow
        assert theirs[:2] == ours[:2]
        assert theirs[4:].rstrip(b"\0") == ours[4:].rstrip(b"\0"), topic
        seen.add(topic.key)
    out = {key for key, row in TABLE.items() if row.sim == "out"}
    assert seen == out


@pytest.mark.parametrize("distro", ["humble", "jazzy"])
def test_identifiers_have_the_length_of_the_release(distro: Any) -> None:
    messages = Messages(distro)
    [(_, (_, detail))] = messages.store.fielddefs["rmw_dds_common/msg/Gid"][1]
    assert detail[1] == messages.gid_size
    assert dds_type_name("geometry_msgs/msg/Twist") == "geometry_msgs::msg::dds_::Twist_"
