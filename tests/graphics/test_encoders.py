"""GIF and PNG encoders on their own, with pictures that are hard on them."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

from irsim.graphics.encoding.gif import GifWriter
from irsim.graphics.encoding.pixels import even, fit
from irsim.graphics.encoding.png import ApngWriter, png_bytes

RNG = np.random.default_rng(7)
LEVELS = (0, 100, 200)
UNCHANGED = [(70, 0, 80, 60), (0, 50, 80, 60), (0, 0, 3, 60), (40, 20, 75, 25)]


def blank(height: int, width: int, level: int = 255) -> np.ndarray:
    return np.full((height, width, 4), level, np.uint8)


def noise(height: int, width: int) -> np.ndarray:
    pixels = RNG.integers(0, 256, (height, width, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    return pixels


def decode(data: io.BytesIO) -> list[np.ndarray]:
    data.seek(0)
    frames = []
    with Image.open(data) as image:
        for index in range(getattr(image, "n_frames", 1)):
            image.seek(index)
            frames.append(np.asarray(image.convert("RGB")))
    return frames


def encode(frames: list[np.ndarray], writer: type = GifWriter, **options: Any) -> tuple[list[np.ndarray], np.ndarray]:
    """The frames of a file as others read them, and the error of each, (frames, H, W, 3)."""
    data = io.BytesIO()
    encoder = writer(data, **options)
    for frame in frames:
        encoder.add(frame)
    encoder.close(1)
    decoded = decode(data)
    assert len(decoded) == len(frames)
    return decoded, np.abs(np.array(decoded, dtype=int) - np.array(frames)[..., :3])


@pytest.mark.parametrize("size", [(1, 1), (3, 70), (64, 64), (5, 1)])
def test_png_is_exact(size: tuple[int, int]) -> None:
    pixels = noise(*size)
    (decoded,) = decode(io.BytesIO(png_bytes(pixels, 96)))
    assert (decoded == pixels[..., :3]).all()


def test_apng_is_exact() -> None:
    frames = [noise(20, 30) for _ in range(3)]
    frames += [frames[-1].copy(), frames[-1].copy()]
    frames[-1][5, 6, 0] ^= 1
    _, errors = encode(frames, ApngWriter, duration=0.04)
    assert errors.max() == 0


def test_gif_of_few_colours_is_exact() -> None:
    frames = [blank(40, 60) for _ in range(5)]
    for k, frame in enumerate(frames):
        frame[10:20, 5 * k : 5 * k + 10, :3] = (0, 158, 115)
    _, errors = encode(frames)
    assert errors.max() <= 3


def test_gif_finds_a_new_palette_when_the_picture_changes() -> None:
    greys, colours = blank(64, 64), blank(64, 64)
    greys[..., :3] = np.arange(64, dtype=np.uint8)[:, None, None] * 4
    colours[..., 0], colours[..., 1], colours[..., 2] = np.arange(64) * 4, (np.arange(64) * 4)[:, None], 128
    _, errors = encode([greys, colours, greys], colors=[(255, 255, 255)])
    assert errors.mean(axis=(1, 2, 3)).max() < 8


def test_gif_of_known_changes_is_that_of_unknown_ones() -> None:
    frames = [blank(60, 80) for _ in range(6)]
    boxes = [(7 * k, 5 * k, 7 * k + 20, 5 * k + 12) for k in range(6)]
    for frame, (left, top, right, bottom) in zip(frames, boxes, strict=True):
        frame[top:bottom, left:right, :3] = RNG.choice(LEVELS, (bottom - top, right - left, 3))
    colors = [(0, 0, 0), (255, 255, 255), *((r, g, b) for r in LEVELS for g in LEVELS for b in LEVELS)]
    files = []
    for known in (False, True):
        data = io.BytesIO()
        writer = GifWriter(data, colors=colors)
        for k, frame in enumerate(frames):
            writer.add(frame, [boxes[k - 1], boxes[k], *UNCHANGED] if known and k else None)
        writer.close(1)
        files.append(data.getvalue())
        for frame, again in zip(frames, decode(data), strict=True):
            assert np.abs(again.astype(int) - frame[..., :3]).max() <= 3
    assert files[0] == files[1]


def test_gif_of_a_large_flat_picture_with_noise_is_read_by_others() -> None:
    frames = [blank(700, 900, 30) for _ in range(2)]
    frames[0][300:420, 100:800, :3] = RNG.integers(0, 2, (120, 700, 1)) * 255
    frames[1][...] = frames[0]
    frames[1][310:420, 150:800, :3] = RNG.integers(0, 2, (110, 650, 1)) * 255
    _, errors = encode(frames, colors=[(30, 30, 30), (0, 0, 0), (255, 255, 255)])
    assert errors.max() == 0


def test_gif_survives_noise() -> None:
    decoded, _ = encode([noise(33, 47) for _ in range(3)])
    assert all(frame.shape == (33, 47, 3) for frame in decoded)


def test_fitting_pads_with_white_and_cuts() -> None:
    dark = blank(3, 5, 0)
    assert even(dark).shape == (4, 6, 4)
    assert (even(dark)[3] == 255).all()
    assert fit(dark, 2, 2).shape == (2, 2, 4)
    assert even(blank(4, 6)).shape == (4, 6, 4)
