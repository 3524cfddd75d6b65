"""What users write."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import irsim
from irsim.bridges.ros.backends.opening import open_backend
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.topics import TABLE
from irsim.common.extras import ExtraError
from irsim.components.bridges._ros import TOPIC_KEYS, TOPIC_NAME
from irsim.components.bridges.ros2 import Ros2
from irsim.diagnostics.errors import ScenarioError

PAGE = Path(__file__).parents[3] / "skills" / "irsim-runner" / "bridges" / "ros2.md"
WORLD = "world: {width: 5, height: 5}\nrobot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}}\n"


def test_the_scenario_of_the_page_is_valid_and_all_topics_are_in_its_table(tmp_path: Path) -> None:
    text = PAGE.read_text()
    [scenario] = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "lab.yaml").write_text(scenario)
    report = irsim.validate(tmp_path / "lab.yaml")
    assert report.valid, report
    assert report.summary.startswith("valid: 1 robot")
    assert [key for key in TABLE if f"`{key}`" not in text] == []


@pytest.mark.parametrize(
    ("bridge", "words"),
    [
        ("{name: ros2, mode: real, clock: irsim}", "real robots move in real time"),
        ("{name: ros2, clock: external}", "ROS does not decide"),
        ("{name: ros2, mode: real, odom_timeout: 2, lost_timeout: 1}", "lost_timeout is below"),
        ("{name: ros2, domain: 500}", "101"),
        ("{name: ros2, max_speed: -1}", "0"),
        ("{name: rosbag, folder: ../../etc/bag}", "folder"),
        ("{name: rosbridge, host: 'a b'}", "host"),
        ("{name: ros2, backend: rospy}", "rclpy"),
        ("{name: ros2, topics: {cmd_val: /cmd_vel}}", "did you mean cmd_vel"),
        ("{name: ros2, topics: {xyz: null}}", "they are clock, tf, "),
        ("{name: rosbag, qos: {skan: {depth: 2}}}", "did you mean scan"),
        ("{name: ros2, topics: {odom: odom}}", "cannot be the name of a topic"),
        ("{name: ros2, robots: [robto_0]}", "write robot_0"),
        ("{name: json_lines, agents: [me], answers: true}", "no object is called 'me'"),
        ("{name: mujoco, report: hall.yaml}", "report: report.json"),  # it would be overwritten
        ("{name: mujoco, agents: [me]}", "no object is called 'me'"),
        ("{name: carla, follow: {me: 3}}", "no object is called 'me'"),
    ],
)
def test_wrong_options_are_named_with_their_line(bridge: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(f"{WORLD}bridges: [{bridge}]\n")
    with pytest.raises(ScenarioError, match=words) as error:
        irsim.make(tmp_path / "a.yaml", display=False)
    assert [found.path[:2] for found in error.value.diagnostics if found.severity == "error"] == [("bridges", 0)]
    assert "3:" in str(error.value)


def test_the_keys_of_topics_are_those_of_the_table() -> None:
    assert tuple(TABLE) == TOPIC_KEYS
    told = str(Ros2.__doc__)
    assert [key for key in TABLE if not re.search(rf"\b{key}\b", told)] == []
    assert all(TOPIC_NAME.fullmatch(row.name) for row in TABLE.values())


@pytest.mark.parametrize(
    ("bridge", "extra"),
    [("ros2, backend: dds", "ros2"), ("ros2, backend: zenoh", "zenoh"), ("rosbridge", "rosbridge"), ("rosbag", "bag")],
)
def test_a_missing_library_is_an_error_that_names_the_command(
    bridge: str, extra: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None)
    (tmp_path / "a.yaml").write_text(f"{WORLD}bridges: [{{name: {bridge}}}]\n")
    env = irsim.make(tmp_path / "a.yaml", display=False)
    with pytest.raises(ExtraError, match=re.escape(f"pip install 'irsim-mcp[{extra}]'")):
        irsim.connect(env)


@pytest.mark.parametrize(
    ("name", "value", "stays"),
    [
        ("ROS_LOCALHOST_ONLY", "1", True),
        ("ROS_LOCALHOST_ONLY", "0", False),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", True),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", False),
    ],
)
def test_variables_of_ros_keep_a_node_on_this_computer(
    name: str, value: str, stays: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    monkeypatch.setattr("irsim.bridges.ros.backends.dds.DdsBackend", lambda *_, loopback, **__: found.append(loopback))
    for variable in ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv(name, value)
    open_backend(Ros2(backend="dds", domain=3), "node", [], Inbox(), None)  # type: ignore[arg-type]
    assert found == [stays]
