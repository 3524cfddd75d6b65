"""``rosbag2``: a bag of ROS 2, which ``ros2 bag play`` plays and Foxglove opens.

The folder has the topics of the format ``mcap``; the scenario, seed, versions and result are in the custom data of
``metadata.yaml``. The option ``storage`` is ``sqlite3``, which opens in all releases of ROS 2, or ``mcap``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.formats._ros_run import write_run
from irsim.bridges.export.registry import Format
from irsim.bridges.ros.backends.bag import BagFolder
from irsim.bridges.ros.messages import Messages
from irsim.options.base import Options

__all__ = ["FORMAT", "BagOptions"]


class BagOptions(Options):
    """How messages are stored."""

    storage: Literal["sqlite3", "mcap"] = "sqlite3"
    """`sqlite3` opens in all releases of ROS 2, `mcap` is the default of recent ones and opens in Foxglove."""


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the messages of a run."""
    [episode] = episodes
    messages = Messages(extra="bag")
    options = episode.options
    assert isinstance(options, BagOptions)
    with BagFolder(target, messages, options.storage, name) as bag:
        return write_run(episode, bag, messages)


FORMAT = Format(
    "rosbag2", "-rosbag2", _write, libraries=("rosbags",), extra="bag", folder=True, options=BagOptions
)  # fmt: skip
