"""The suite ``pedestrians_v1``: a robot among the people of ETH, hotel and zara01, from files that the user has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.imitation import RADIUS
from irsim.bridges.pedestrians.scenario import Layout, checked
from irsim.bridges.pedestrians.suite import POLICIES, Episodes, windows_of
from irsim.bridges.pedestrians.tracks import Window, frame_rate, make_tracks, read_recording
from irsim.common.files import write_new
from irsim.common.hashing import file_digest
from irsim.diagnostics.errors import ArgumentError

__all__ = ["RECORDINGS", "SHA256", "WrittenSuite", "write_pedestrians_suite"]

NAME = "pedestrians_v1"
RECORDINGS = ("eth", "hotel", "zara01")
"""Recordings of the suite: ``seq_eth`` and ``seq_hotel`` of ETH BIWI, ``crowds_zara01`` of UCY."""
SHA256 = {
    "eth": "d452ae2185ecb1164c2fdf31e75f6236f4c2ffc02c751a6b2ae921740cbc60d1",
    "hotel": "2b8577595204a6b780b80258fd50da35adb7293e3e06ad6f8e1b60965e7dde6e",
    "zara01": "1147a1962a09abfb86f28c6cddcac862e095a0cf129b3016385b69eacdd09d85",
}
"""Recording -> SHA-256 of the file that the published results are of; other files give a suite of their own."""
WINDOWS = 10
"""Largest number of windows of a recording."""
_HEAD = f"""\
# Written by `irsim bridge pedestrians-suite`. The places of people are data of the recordings' authors.

suite: {NAME}
version: 1
title: "One robot crosses recorded people of ETH, hotel and zara01"
about: >-
  Windows of recordings of real people, named after the recording and the second in which they start. Each seed
  draws another start and goal of the robot in the recorded area, at least 60 % of its longer side apart. People
  walk as they were recorded and do not see the robot: it has to give way to all people, which real people would not
  ask of it. The robot gathers at most 1 m/s and 4 rad/s in a second; arcs are exact within a step, and contacts
  count at every time. An episode ends with the first contact of the robot.
sources:
  - "Pellegrini, Ess, Schindler, van Gool: You'll never walk alone (2009): ETH and hotel"
  - "Lerner, Chrysanthou, Lischinski: Crowds by example (2007): zara01"
  - "Biswas et al.: SocNavBench (arXiv 2103.00047): a robot among replayed people"
scenarios:
"""
_TAIL = (
    """\
overrides: {"world.contacts": swept, "world.integration": exact, "robot[*].acce": [1, 4]}
seeds: {first: 100000, count: 10, full: 100}
seconds: 60
until: first_collision
"""
    + POLICIES
    + """\
others:
  avocado: avocado
  footprint_orca: footprint_orca
"""
)


@dataclass(frozen=True)
class WrittenSuite:
    """A suite that was written.

    Attributes:
        file: The suite.
        windows: Recording -> number of its windows.
        lengths: Recording -> length of its windows [s].
        other: Recordings whose file is not the one that the published results were made with.
    """

    file: str
    windows: dict[str, int]
    lengths: dict[str, float]
    other: list[str]


def write_pedestrians_suite(
    files: Mapping[str, str | Path], out: str | Path, *, overwrite: bool = False
) -> WrittenSuite:
    """Write the suite. The same files give the same suite, byte by byte.

    Args:
        files: A file for each of :data:`RECORDINGS`, with rows of places in metres that are 0.4 s apart.
        out: The suite file.
        overwrite: Replace a file that exists.

    Raises:
        BridgeError: A file cannot be used.
        ArgumentError: A recording is missing.
        TargetError: The suite exists.
    """
    missing = [name for name in RECORDINGS if name not in files]
    if missing:
        raise ArgumentError(f"{NAME} has no file for {' and '.join(missing)}", f"name one for each of {RECORDINGS}")
    text, windows, lengths = _HEAD, dict[str, int](), dict[str, float]()
    for name in RECORDINGS:
        path = Path(files[name])
        recording = read_recording(path)
        if recording.format == "vsp":
            what = f"{path.name} has splines in pixels instead of rows of places in metres"
            raise BridgeError("bridge-file", what, "give ETH's obsmat.txt, or lines 'frame id x y'")
        tracks, _ = make_tracks(recording, recording.place, frame_rate(recording), Window())
        made = windows_of(tracks, Layout(path.name, radius=RADIUS), Episodes(WINDOWS), word=name, own=True)
        text += "".join(f"{line}\n" for line in made.lines)
        windows[name], lengths[name] = len(made.starts), made.length
    write_new(Path(out), checked(text + _TAIL), overwrite=overwrite)
    other = [name for name in RECORDINGS if file_digest(Path(files[name])) != SHA256[name]]
    return WrittenSuite(str(out), windows, lengths, other)
