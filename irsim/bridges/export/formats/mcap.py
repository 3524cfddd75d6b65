"""``mcap``: ROS 2 messages, which Foxglove, PlotJuggler and ``ros2 bag play`` show without irsim.

All stamps are simulated time, the fixed frame is ``world``, and the topics are:

- ``/clock``, and ``/tf`` from ``world`` to ``<name>/base_link`` of each object that moves, in every step
- ``/<robot>/odom`` (twist in the body frame), ``/<robot>/scan``, ``/<robot>/scan_1``, … in every step; the range of a
  beam that hit nothing is infinite
- ``/<robot>/goal`` whenever it changes, and ``/obstacles``, a PoseArray of the moving obstacles, in every step
- ``/rosout`` with the events
- once, for those who subscribe later as well: ``/tf_static`` with the mounts of the lidars, ``/markers`` with all
  bodies, and ``/map``

Names of objects become parts of topics and frames with letters, digits and underscores only. The file has the scenario
as an attachment, and seed, versions and result as metadata ``irsim``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from irsim.bridges.export.episode import Episode
from irsim.bridges.export.formats._mcap_file import Bag
from irsim.bridges.export.formats._ros_run import write_run
from irsim.bridges.export.registry import Format
from irsim.bridges.ros.messages import Messages

__all__ = ["FORMAT"]


def _write(episodes: Sequence[Episode], target: Path, name: str) -> list[str]:
    """Write the messages of a run."""
    [episode] = episodes
    messages = Messages(extra="records")
    with Bag(target, messages) as bag:
        return write_run(episode, bag, messages)


FORMAT = Format("mcap", ".mcap", _write, libraries=("mcap", "rosbags"))
