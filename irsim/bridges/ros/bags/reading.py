"""Poses and scans of a bag as arrays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.bags.transforms import Pose, Transforms, frame
from irsim.bridges.ros.incoming import MessageError, Scan, read_odometry, read_scan
from irsim.bridges.ros.messages import MAX_SEQUENCE
from irsim.common.arrays import Floats
from irsim.common.extras import require
from irsim.common.text import clean
from irsim.common.yaml.plain import read_plain_yaml

__all__ = ["Recorded", "read_bag"]

_ODOMETRY, _SCAN = "nav_msgs/msg/Odometry", "sensor_msgs/msg/LaserScan"
_TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
_MOVING, _FIXED = "/tf", "/tf_static"
MAX_POSES = 1_000_000
MAX_SCANS = 200_000


@dataclass
class Recorded:
    """Recorded data of one robot in a bag.

    Attributes:
        times: (T,) [s] since the first pose, increasing.
        poses: (T, 3) x, y [m], yaw [rad], frame of the odometry, or outermost frame of the transforms.
        scan_times: Times of the scans [s].
        scans: The scans, in their order.
        mount: x, y [m], yaw [rad] of the lidar on the robot; None if the bag does not say.
        odom_topic, scan_topic: Where poses and scans come from; no scans without a topic.
        ignored: How many messages were not usable.
        elsewhere: Whether the bag has scans, but of other robots only.
    """

    times: Floats
    poses: Floats
    scan_times: Floats
    scans: list[Scan]
    mount: tuple[float, float, float] | None
    odom_topic: str
    scan_topic: str | None
    ignored: int
    elsewhere: bool = False


def read_bag(path: Path, odom: str | None, scan: str | None) -> Recorded:
    """Read a bag of ROS 1 (``.bag``) or ROS 2 (a folder).

    Args:
        path: The bag.
        odom: Topic of the odometry, or ``/tf``; default: the only one, and ``/tf`` in a bag without odometry.
        scan: Topic of the scans; default: the only one of the same robot, if there is one.

    Raises:
        BridgeError: The bag is damaged, or has no such topic.
        ExtraError: rosbags is missing.
    """
    require("bag", "rosbags")
    if not path.exists():
        raise BridgeError("bridge-file", f"'{clean(path, 200)}' does not exist", "name a .bag file or a rosbag2 folder")
    with _opened(path) as reader:
        odom_topic = _source(reader, odom)
        scan_topic = _scan_of(reader, odom_topic) if scan is None else _chosen(reader, _SCAN, scan, "--scan")
        elsewhere = scan_topic is None and any(one.msgtype == _SCAN for one in reader.connections)
        rows: list[tuple[float, float, float, float]] = []
        scans: list[tuple[float, Scan]] = []
        transforms, frames, ignored = Transforms(), ["", ""], 0
        wanted = [one for one in reader.connections if one.topic in (odom_topic, scan_topic, _FIXED)]
        for connection, stamp, raw in reader.messages(connections=wanted):
            try:
                message = reader.deserialize(raw, connection.msgtype)
                if connection.msgtype in _TRANSFORMS:
                    transforms.add(message, fixed=connection.topic == _FIXED)
                elif connection.topic == odom_topic:
                    frames[0] = frame(message.child_frame_id)
                    rows.append((_time(message, stamp), *read_odometry(message).pose))
                elif connection.topic == scan_topic:
                    frames[1] = frame(message.header.frame_id)
                    scans.append((_time(message, stamp), read_scan(message)))
            except MessageError:
                ignored += 1
            if len(rows) > MAX_POSES or len(scans) > MAX_SCANS:
                raise BridgeError("bridge-file", f"the bag has more than {MAX_POSES} poses or {MAX_SCANS} scans",
                                  "cut it: ros2 bag convert")  # fmt: skip
    mount: Pose | None = transforms.fixed.get((frames[0], frames[1]))
    if odom_topic == _MOVING:
        if scan_topic is None:
            what = "the bag has transforms and no odometry, and no scans that say which frame is the robot's"
            raise BridgeError("bridge-file", what, "record the odometry, or the scans, too")
        rows, mount = transforms.driven(frames[1])
    result = _recorded(rows, scans, mount, odom_topic, scan_topic, ignored)
    result.elsewhere = elsewhere
    return result


def _recorded(
    rows: list[tuple[float, float, float, float]], scans: list[tuple[float, Scan]],
    mount: tuple[float, float, float] | None, odom_topic: str, scan_topic: str | None, ignored: int,
) -> Recorded:  # fmt: skip
    if len(rows) < 2:
        what = f"{odom_topic} has {len(rows)} usable message(s)"
        raise BridgeError("bridge-file", what, "name another topic with --odom")
    table = np.array(sorted(rows))
    table = table[np.concatenate([[True], np.diff(table[:, 0]) > 1e-6])]
    start = table[0, 0]
    scans.sort(key=lambda one: one[0])
    return Recorded(
        table[:, 0] - start,
        table[:, 1:],
        np.array([when for when, _ in scans]) - start,
        [one for _, one in scans],
        mount,
        odom_topic,
        scan_topic,
        ignored,
    )


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """A reader of a bag; whatever rosbags raises about its content becomes one error."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    metadata = path / "metadata.yaml"
    try:
        if metadata.is_file():
            read_plain_yaml(metadata)  # rosbags reads it without limits
        with AnyReader([path], default_typestore=store) as reader:
            reader.typestore.max_sequence_length = MAX_SEQUENCE
            yield reader
    except BridgeError:
        raise
    except Exception as error:  # damaged files raise errors of many kinds
        what = f"'{clean(path, 200)}' is not a bag that can be read: {clean(error, 200)}"
        raise BridgeError("bridge-file", what, "name a .bag file, or a folder with metadata.yaml") from None


def _source(reader: Any, odom: str | None) -> str:
    """The topic of poses: odometry, or the transforms where they are named or all there is."""
    kinds = {one.topic: one.msgtype for one in reader.connections}
    has_odometry = _ODOMETRY in kinds.values()
    if kinds.get(_MOVING) in _TRANSFORMS and (odom == _MOVING or (odom is None and not has_odometry)):
        return _MOVING
    chosen = _chosen(reader, _ODOMETRY, odom, "--odom")
    assert chosen is not None
    return chosen


def _scan_of(reader: Any, odom: str) -> str | None:
    """The only topic of scans beside the odometry's topic, or else the only one that is not beside another odometry."""
    topics = {kind: sorted({one.topic for one in reader.connections if one.msgtype == kind})
              for kind in (_SCAN, _ODOMETRY)}  # fmt: skip
    own = [name for name in topics[_SCAN] if _space(name) == _space(odom)]
    if len(own) == 1:
        return str(own[0])
    others = {_space(name) for name in topics[_ODOMETRY]} - {_space(odom)}
    if own or not all(_space(name) in others for name in topics[_SCAN]):
        return _chosen(reader, _SCAN, None, "--scan", needed=False)
    return None


def _space(topic: str) -> str:
    return topic.rpartition("/")[0]


def _chosen(reader: Any, kind: str, name: str | None, option: str, *, needed: bool = True) -> str | None:
    """The topic of a type: the one that is named, or the only one."""
    names = sorted({one.topic for one in reader.connections if one.msgtype == kind})
    short = kind.replace("/msg/", "/")
    listed = ", ".join(clean(one, 60) for one in names[:10]) or "none"
    if name is not None:
        if name not in names:
            what = f"no topic {clean(name, 60)!r} with messages {short}; there are: {listed}"
            raise BridgeError("bridge-file", what, f"name another one with {option}")
        return name
    if not names and not needed:
        return None
    if len(names) != 1:
        what = f"the bag has {len(names)} topics with messages {short}: {listed}"
        raise BridgeError("bridge-file", what, f"name one with {option}" if names else "record the topic, too")
    return str(names[0])


def _time(message: Any, stamp: int) -> float:
    """Time of a message [s], from its header, or from the recording if the header has no time."""
    time = message.header.stamp
    seconds = float(time.sec) + float(time.nanosec) / 1e9
    return seconds if seconds > 0 else stamp / 1e9
