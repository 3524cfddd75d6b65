"""One HTML page that shows splats with a recorded run in them; it needs neither a network nor other files."""

from __future__ import annotations

import base64
import html
import json
import math
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from isal import isal_zlib
from numpy.typing import NDArray

from irsim.bridges.export.cameras import PoseOptions, scene_of
from irsim.bridges.frames import inverse
from irsim.bridges.splats.reading import read_splats
from irsim.bridges.splats.recording import Recording, open_recording
from irsim.bridges.splats.splats import Splats, moved
from irsim.common.files import check_suffix, code_of, replacing
from irsim.common.outline import triangles_of
from irsim.common.pages import bundle, one_page
from irsim.common.text import clean
from irsim.runs.files import RunError
from irsim.runs.reading import Run, open_run
from irsim.scenario.limits import Limits

__all__ = ["MAX_PAGE_SPLATS", "PageFile", "write_page"]

MAX_PAGE_SPLATS = 1_000_000
"""Splats of a page unless the caller decides; they take 15 to 25 MB of the page."""
_MAX_ROWS = 4000
"""Steps of a page."""
_SOURCES = Path(__file__).with_name("web")
_FOV_DEG = 60.0
_LARGEST_RATIO = 12.0
"""Logarithm of the ratio of the largest to the smallest standard deviation that the page tells apart."""


@dataclass(frozen=True)
class PageFile:
    """A page that was written.

    Attributes:
        file: Its path.
        bytes: Its size.
        splats: Number of splats that it has.
        of: Number of splats of the scene.
        objects: Number of objects that it shows.
        last_step: Last step that it shows.
        notes: Sentences on things that it leaves out.
    """

    file: str
    bytes: int
    splats: int
    of: int
    objects: int
    last_step: int
    notes: list[str]

    def as_dict(self) -> dict[str, Any]:
        """The result as JSON types."""
        return dict(self.__dict__)


def write_page(
    splats: str | Path,
    run: str | Path | Run,
    out: str | Path,
    *,
    options: PoseOptions | None = None,
    max_splats: int = MAX_PAGE_SPLATS,
    workspace: str | Path | None = None,
    limits: Limits | None = None,
) -> PageFile:
    """Write a page with splats and a recorded run.

    Args:
        splats: The ``.ply`` file of the scene.
        run: Id of the run, its folder, or ``last``.
        out: The ``.html`` file to write; an existing one is replaced.
        options: Where the scene is; default: as the sidecar of the map says.
        max_splats: Splats that add least to the picture are left out above this number.
        workspace: Folder whose ``.irsim/runs`` holds the run.
        limits: Limits of the reader of the scenario.

    Raises:
        BridgeError: The file of splats or the sidecar cannot be used.
        RunError: There is no such run, or the page cannot be written.
        TargetError: The page has another suffix.
    """
    target, where = Path(out), options or PoseOptions()
    check_suffix(target, (".html", ".htm"))
    opened = run if isinstance(run, Run) else open_run(run, workspace)
    scene_of(opened, where, limits, "irsim")  # mistakes first
    scene = read_splats(splats)
    every = max(where.every, -(-(opened.last_step + 1) // _MAX_ROWS))
    recording = open_recording(opened, where, every=every, limits=limits)
    notes = [*recording.world.notes]
    kept = _most_visible(scene, max_splats)
    if len(kept) < len(scene):
        notes.append(f"the page has {len(kept):,} of {len(scene):,} splats; --max-splats changes that")
    head, columns = _content(moved(kept, inverse(recording.world.transform)), recording, Path(splats).name, where)
    content = base64.b64encode(_packed(head, columns)).decode()
    text = one_page(_SOURCES, bundle(_SOURCES), "worker-src blob:", title=html.escape(head["title"]), data=content)
    try:
        with replacing(target) as temporary:
            temporary.write_text(text, encoding="utf-8")
    except OSError as error:
        what = f"'{clean(target, 200)}' cannot be written: {error.strerror or error}"
        raise RunError(code_of(error), what, "name another file with -o") from None
    last = int(recording.step[-1])
    size = target.stat().st_size
    return PageFile(str(target), size, len(kept), len(scene), len(recording.bodies), last, notes)


def _most_visible(splats: Splats, count: int) -> Splats:
    """At most so many splats, those with the largest product of opacity and area, in the order of the file."""
    if len(splats) <= count:
        return splats
    scale = np.sort(splats.scale, axis=1)
    weight = splats.opacity * np.minimum(scale[:, 1] * scale[:, 2], 1.0)
    return splats.take(np.sort(np.argpartition(weight, len(weight) - count)[len(weight) - count :]))


def _content(
    splats: Splats, recording: Recording, name: str, options: PoseOptions
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """The head of the data, and its arrays."""
    logs = np.log(splats.scale)
    high = float(logs.max())
    low = max(float(logs.min()), high - _LARGEST_RATIO)
    step = max((high - low) / 255, 1e-6)
    color = np.column_stack([splats.color, splats.opacity])
    columns: dict[str, NDArray[Any]] = {
        "center": splats.center.astype("<f4"),
        "scale": np.round((np.maximum(logs, low) - low) / step).astype("u1"),
        "rotation": np.round(127 * splats.rotation).astype("i1"),
        "color": np.round(255 * np.clip(color, 0, 1)).astype("u1"),
        "pose": recording.pose.astype("<f4"),
    }
    objects = [
        {
            "name": clean(body.name, 60),
            "color": body.color,
            "height": body.height,
            "outlines": body.outlines,
            "triangles": triangles_of(body.shape).reshape(-1, 2).tolist(),
            "path": body.role == "robot",
        }
        for body in recording.bodies
    ]
    low_corner, high_corner = np.array(recording.scene.low), np.array(recording.scene.high)
    middle, size = (low_corner + high_corner) / 2, float(np.linalg.norm(high_corner - low_corner))
    head = {
        "title": f"{clean(recording.scene.name, 80)} in {clean(name, 80)}",
        "facts": f"run {recording.run.id}, seed {recording.scene.seed}, {len(splats):,} splats",
        "scales": [low, step],
        "objects": objects,
        "rows": len(recording.step),
        "times": recording.time.tolist(),
        "top": max(0.5, float(np.percentile(splats.center[:, 2], 99.5)) + 0.1),
        "camera_height": options.height,
        "fov": math.radians(_FOV_DEG),
        "eye": {"target": [*middle.tolist(), 0.0], "distance": 1.1 * size, "azimuth": math.pi / 2, "elevation": 1.1},
    }
    return head, columns


def _packed(head: dict[str, Any], columns: dict[str, NDArray[Any]]) -> bytes:
    """Head and arrays as one zlib stream, which ``web/read.js`` reads."""
    listed: list[dict[str, Any]] = [
        {"name": name, "kind": f"{values.dtype.kind}{values.dtype.itemsize}", "begin": 0, "count": values.size}
        for name, values in columns.items()
    ]
    begin = 0
    for _ in range(3):  # the length of the head depends on the numbers in it
        text = json.dumps({**head, "columns": listed}, allow_nan=False).encode()
        at = begin = -(-(4 + len(text)) // 16) * 16 + 64
        for entry, values in zip(listed, columns.values(), strict=True):
            entry["begin"] = at
            at = -(-(at + values.nbytes) // 16) * 16
    block = bytearray(at)
    text = json.dumps({**head, "columns": listed}, allow_nan=False).encode()
    assert 4 + len(text) <= begin
    block[: 4 + len(text)] = struct.pack("<I", len(text)) + text
    for entry, values in zip(listed, columns.values(), strict=True):
        block[entry["begin"] : entry["begin"] + values.nbytes] = values.tobytes()
    packed: bytes = isal_zlib.compress(bytes(block), 2)
    return packed
