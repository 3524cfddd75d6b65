"""``mcap``: ROS 2 messages, which Foxglove, PlotJuggler and ``ros2 bag play`` show without irsim.

All stamps are simulated time, the fixed frame is ``world``, and the topics are:

- ``/clock``, and ``/tf`` from ``world`` to ``<name>/base_link`` of each object that moves, in every step
- ``/<robot>/odom`` (the true pose, without drift and with zero covariance; twist in the body frame),
  ``/<robot>/scan``, ``/<robot>/scan_1``, … in every step; the range of a beam that hit nothing is infinite,
  and a scan with ``sweep`` has the stamp of its first beam
- what sensors without beams report, in every step: ``/<robot>/imu`` (accelerations with gravity; its orientation is not
  known), ``/<robot>/wheel_odom`` (``odometry``, in coordinates of ``world``), ``/<robot>/gnss`` (from
  ``origin``), ``/<robot>/sonar``, ``/<robot>/ir_range`` and ``/<robot>/localization``; ``_1`` for a second one
- ``/<robot>/goal`` whenever it changes, and ``/obstacles``, a PoseArray of the moving obstacles, in every step
- ``/rosout`` with the events
- latched, whenever objects come or go: ``/markers`` with all bodies that are there, in place of those before, and
  ``/obstacles/ids`` with the names of the poses of ``/obstacles`` as a JSON list
- once, for those who subscribe later as well: ``/tf_static`` with the mounts of the sensors, and ``/map``

Who is not in the world at a time is in no message of that time.

Names of objects become parts of topics and frames with letters, digits and underscores only. The file has the scenario
as an attachment, and seed, versions and result as metadata ``irsim``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.formats._ros_run import write_run
from irsim.bridges.export.registry import Format
from irsim.bridges.ros.messages import Messages

__all__ = ["FORMAT", "Bag"]

_LATCHED = """\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
"""
"""Quality of service of topics whose last message new subscribers get, as rosbag2 stores it: keep the last one,
reliable, transient local."""


class Bag:
    """An MCAP file with the profile ``ros2``, to which messages are added.

    Args:
        target: The file.
        messages: Makes the messages.
    """

    def __init__(self, target: Path, messages: Messages) -> None:
        from mcap.writer import Writer

        self._file = open(target, "wb")  # noqa: SIM115
        self._writer = Writer(self._file)
        self._writer.start(profile="ros2", library="irsim")
        self._store = messages.store
        self._schemas: dict[str, int] = {}
        self._counts: dict[int, int] = {}

    def __enter__(self) -> Bag:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                self._writer.finish()
        finally:
            self._file.close()

    def topic(self, name: str, kind: str, *, latched: bool = False, **about: str) -> tuple[int, str]:
        """Add a topic.

        Args:
            name: Its name.
            kind: Type of its messages, such as ``sensor_msgs/msg/LaserScan``.
            latched: Whether new subscribers get its last message.
            **about: Further metadata of the channel.

        Returns:
            The handle that :meth:`add` takes.
        """
        if kind not in self._schemas:
            definition, _ = self._store.generate_msgdef(kind, ros_version=2)
            self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", definition.encode())
        metadata = {**about, **({"offered_qos_profiles": _LATCHED} if latched else {})}
        return self._writer.register_channel(name, "cdr", self._schemas[kind], metadata), kind

    def add(self, topic: tuple[int, str], stamp: int, message: Any) -> None:
        """Add a message at a simulated time [ns]."""
        channel, kind = topic
        sequence = self._counts[channel] = self._counts.get(channel, 0) + 1
        data = bytes(self._store.serialize_cdr(message, kind))
        self._writer.add_message(channel, stamp, data, stamp, sequence)

    def describe(self, facts: dict[str, str], files: dict[str, bytes]) -> None:
        """Add metadata named ``irsim``, and files as attachments."""
        self._writer.add_metadata("irsim", facts)
        for name, content in files.items():
            kind = "application/json" if name.endswith(".json") else "application/yaml"
            self._writer.add_attachment(0, 0, name, kind, content)


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the messages of a run."""
    [episode] = episodes
    messages = Messages(extra="records")
    with Bag(target, messages) as bag:
        return write_run(episode, bag, messages)


FORMAT = Format("mcap", ".mcap", _write, libraries=("mcap", "rosbags"))
