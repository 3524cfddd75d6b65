"""Stores frames while a simulation runs, and writes them as an animation: GIF, APNG or video."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, Protocol, cast
from weakref import finalize

import numpy as np
from isal import isal_zlib
from PIL import Image

from irsim.common.files import replacing
from irsim.diagnostics.errors import InputError
from irsim.graphics.encoding.gif import Box, GifWriter
from irsim.graphics.encoding.picture_files import MOVING_SUFFIXES, VIDEO_SUFFIXES
from irsim.graphics.encoding.pixels import Pixels, fit, from_image
from irsim.graphics.encoding.png import ApngWriter
from irsim.graphics.encoding.video import VideoWriter

__all__ = ["ANIMATION_SUFFIXES", "AnimationOptions", "FrameBuffer", "FrameWriter", "write_frames"]

ANIMATION_SUFFIXES = (".png", *MOVING_SUFFIXES)
"""File suffixes of animations."""


class FrameWriter(Protocol):
    """Writes an animation frame by frame."""

    frames: int

    def add(self, pixels: Pixels) -> None:
        """Append a frame."""

    def close(self, last_duration: float) -> None:
        """Finish the file; the last frame is shown for ``last_duration`` seconds."""


@dataclass
class AnimationOptions:
    """Playback options of an animation.

    Attributes:
        fps: Frames per second.
        last_frame_duration: Duration of the last frame of a GIF or APNG [s].
        loop: Number of repetitions of a GIF or APNG; 0 repeats without end.
        video: Options of the video encoder.
    """

    fps: float = 10.0
    last_frame_duration: float = 1.0
    loop: int = 0
    video: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.fps > 0:
            raise InputError(f"fps must be positive, got {self.fps}")

    @property
    def last(self) -> float:
        """Duration of the last frame, never shorter than the others [s]."""
        return max(1 / self.fps, float(self.last_frame_duration))


@contextmanager
def write_frames(
    path: Path, options: AnimationOptions, colors: Sequence[tuple[int, int, int]] = ()
) -> Iterator[FrameWriter]:
    """Write an animation; the file appears only if the block ends without an error.

    Args:
        path: File to write; its suffix chooses GIF, APNG or a video format.
        options: Playback options.
        colors: (r, g, b) colours that a GIF must reproduce exactly.

    Raises:
        ValueError: The suffix is not supported.
    """
    check_suffix(path.suffix)
    with replacing(path) as temporary:
        if path.suffix.lower() in VIDEO_SUFFIXES:
            video = VideoWriter(temporary, fps=options.fps, **options.video)
            try:
                yield video
                video.close()
            finally:
                video.abandon()
            return
        with temporary.open("w+b") as file:
            writer: FrameWriter
            if path.suffix.lower() == ".gif":
                writer = GifWriter(file, duration=1 / options.fps, loop=options.loop, colors=colors)
            else:
                writer = ApngWriter(file, duration=1 / options.fps, loop=options.loop)
            yield writer
            writer.close(options.last)


def check_suffix(suffix: str) -> None:
    """Raise ValueError if animations cannot have this suffix."""
    if suffix.lower() not in ANIMATION_SUFFIXES:
        raise InputError(f"cannot save an animation as {suffix!r}", f"choose one of {', '.join(ANIMATION_SUFFIXES)}")


class FrameBuffer:
    """Frames of one environment, in a temporary file that is deleted together with the buffer.

    Args:
        options: Playback options.
        indexed: Store the frames as a GIF (256 colours) rather than in full colour; saving a GIF is then a mere copy.
        colors: (r, g, b) colours that a GIF must reproduce exactly.
    """

    def __init__(
        self, options: AnimationOptions, *, indexed: bool, colors: Sequence[tuple[int, int, int]] = ()
    ) -> None:
        self.options, self.colors = options, list(colors)
        self.counts: list[int] = []
        self._file = cast(BinaryIO, tempfile.TemporaryFile())  # noqa: SIM115 (lives as long as the buffer)
        finalize(self, self._file.close)
        self._gif: GifWriter | None = None
        if indexed:
            self._gif = GifWriter(self._file, duration=1 / options.fps, loop=options.loop, colors=colors)
        self._finished = False
        self._last: Pixels | None = None
        self._offsets: list[int] = []
        self._size: tuple[int, int] | None = None

    @property
    def frames(self) -> int:
        """Number of stored frames."""
        return len(self.counts)

    def add(self, pixels: Pixels, count: int, changed: Sequence[Box] | None = None) -> None:
        """Store a frame, cut or padded to the size of the first.

        Args:
            pixels: The frame, whose memory may change afterwards.
            count: Number of the step that the frame shows.
            changed: Boxes outside of which it is as the frame before; None if that is not known.
        """
        if self._size is None:
            self._size = pixels.shape[1], pixels.shape[0]
        pixels = fit(pixels, *self._size)
        if self._gif is not None:
            self._gif.add(pixels, changed)
        else:
            change = pixels.copy() if self._last is None else pixels ^ self._last
            self._offsets.append(self._file.tell())
            self._file.write(isal_zlib.compress(change, 1))
            self._last = pixels.copy()
        self.counts.append(count)

    def save(self, path: Path, options: AnimationOptions) -> None:
        """Write the animation; no frames can be added after that.

        Raises:
            ValueError: The buffer is empty, or the suffix is not supported.
        """
        if not self.frames:
            raise InputError("an animation must have at least one frame, got none")
        same = (options.fps, options.loop) == (self.options.fps, self.options.loop)
        if path.suffix.lower() == ".gif" and self._gif is not None and same:
            self._finish(self._gif, options.last)
            with replacing(path) as temporary, temporary.open("wb") as target:
                shutil.copyfileobj(self._file, target)
            return
        with write_frames(path, options, self.colors) as writer:
            for pixels in self.read():
                writer.add(pixels)

    def read(self) -> Iterator[Pixels]:
        """Iterate over the frames in order; no frames can be added after that."""
        if self._gif is not None:
            self._finish(self._gif, self.options.last)
            with Image.open(self._file) as image:
                for index in range(self.frames):
                    image.seek(index)
                    yield from_image(image)
            return
        self._file.seek(0, 2)
        ends = [*self._offsets[1:], self._file.tell()]
        assert self._size is not None
        frame: Pixels = np.zeros((self._size[1], self._size[0], 4), np.uint8)
        for start, end in zip(self._offsets, ends, strict=True):
            self._file.seek(start)
            change = np.frombuffer(isal_zlib.decompress(self._file.read(end - start)), np.uint8)
            frame = frame ^ change.reshape(frame.shape)
            yield frame

    def _finish(self, gif: GifWriter, last_duration: float) -> None:
        if not self._finished:
            gif.close(last_duration)
        self._finished = True
        self._file.seek(0)

    def close(self) -> None:
        """Close and delete the temporary file."""
        self._file.close()
