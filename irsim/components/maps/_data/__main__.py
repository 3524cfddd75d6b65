"""Draws the bundled maps: black is occupied, white is free; one pixel is 0.1 m in a world of 50 m.

Usage: ``python -m irsim.components.maps._data [folder]``; every run writes the same files.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

Grid = NDArray[np.bool_]
_CAVE, _OFFICE, _MAZE, _FLAT = 500, 500, 410, 400
_FREE, _WALL = 255, 0


def rock_around(rock: Grid) -> NDArray[np.int_]:
    """Number of rock cells among the nine cells at and around each cell; the outside counts as rock."""
    padded = np.pad(rock, 1, constant_values=True).astype(np.int_)
    rows, columns = rock.shape
    return sum(
        (padded[a : a + rows, b : b + columns] for a in range(3) for b in range(3)), np.zeros_like(padded[1:-1, 1:-1])
    )


def reachable(free: Grid, start: tuple[int, int]) -> Grid:
    """The free cells that can be reached from ``start``."""
    reached = np.zeros_like(free)
    reached[start] = True
    while True:
        grown = reached.copy()
        grown[1:] |= reached[:-1]
        grown[:-1] |= reached[1:]
        grown[:, 1:] |= reached[:, :-1]
        grown[:, :-1] |= reached[:, 1:]
        grown &= free
        if (grown == reached).all():
            return reached
        reached = grown


def cave(seed: int = 2024) -> Image.Image:
    """A cave made by a cellular automaton, with free chambers where scripts put robots and goals.

    Chambers lie at 10, 50 and 90 % of the world's extent along both axes, and are joined to each other.
    """
    size = 100
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[0:size, 0:size]
    keep = np.zeros((size, size), dtype=bool)
    places = [(r, c) for r in (10, 50, 90) for c in (10, 50, 90)]
    for r, c in places:
        keep |= np.hypot(rows - r, columns - c) < 6.5
    winding = 3.0 * np.sin(np.arange(size) / 7.0)
    for middle in (10, 50, 90):  # passages between the chambers
        keep |= (np.abs(rows - middle - winding[columns]) < 2.2) & (columns >= 8) & (columns <= 91)
        keep |= (np.abs(columns - middle + winding[rows]) < 2.2) & (rows >= 8) & (rows <= 91)
    rock = rng.random((size, size)) < 0.47
    for _ in range(6):
        rock = rock_around(rock) >= 5
        rock[keep] = False
    rock[[0, -1]] = rock[:, [0, -1]] = True
    rock |= ~reachable(~rock, (10, 10))
    fine = np.kron(rock, np.ones((_CAVE // size, _CAVE // size), dtype=bool))
    for _ in range(4):  # smooth the steps
        fine = rock_around(fine) >= 5
    fine[:2] = fine[-2:] = fine[:, :2] = fine[:, -2:] = True
    return Image.fromarray(np.where(fine, _WALL, _FREE).astype(np.uint8))


def plan(size: int, walls: list[tuple[int, int, int, int]], doors: list[tuple[int, int, int, int]]) -> Image.Image:
    """A floor plan: boxes (left, top, right, bottom) of wall, and boxes of free space cut into them [px]."""
    image = Image.new("L", (size, size), _FREE)
    pen = ImageDraw.Draw(image)
    for box in walls:
        pen.rectangle(box, fill=_WALL)
    for box in doors:
        pen.rectangle(box, fill=_FREE)
    return image


def frame(size: int, thick: int) -> list[tuple[int, int, int, int]]:
    """Outer walls."""
    last = size - 1
    return [
        (0, 0, last, thick - 1),
        (0, size - thick, last, last),
        (0, 0, thick - 1, last),
        (size - thick, 0, last, last),
    ]


def office() -> Image.Image:
    """Two rows of rooms along corridors, an open hall with pillars and desks between them."""
    size, t = _OFFICE, 3
    walls = frame(size, t)
    doors = []
    for wall, first in ((150, 0), (350, 0)):  # between rooms and hall
        walls.append((first, wall, size - 1, wall + t - 1))
    for number in range(1, 4):
        x = number * 125
        walls += [(x, 0, x + t - 1, 150), (x, 350, x + t - 1, size - 1)]
    for number in range(4):
        x = number * 125 + 50
        doors += [(x, 150, x + 22, 150 + t - 1), (x, 350, x + 22, 350 + t - 1)]
    for x in (150, 250, 350):
        for y in (200, 300):
            walls.append((x - 5, y - 5, x + 5, y + 5))
    for number in range(4):
        left = number * 125 + 78
        walls += [(left, 12, left + 34, 28), (left, size - 29, left + 34, size - 13)]
    return plan(size, walls, doors)


def maze(seed: int = 7) -> Image.Image:
    """A perfect maze by depth-first search: ten by ten halls of 38 px, walls of 3 px; each reaches all others."""
    cells, step, t = 10, 41, 3
    rng = np.random.default_rng(seed)
    open_walls: set[tuple[tuple[int, int], tuple[int, int]]] = set()
    path, seen = [(0, 0)], {(0, 0)}
    while path:
        r, c = path[-1]
        around = [(r + a, c + b) for a, b in ((0, 1), (1, 0), (0, -1), (-1, 0))]
        fresh = [p for p in around if p not in seen and 0 <= p[0] < cells and 0 <= p[1] < cells]
        if not fresh:
            path.pop()
            continue
        chosen = fresh[int(rng.integers(len(fresh)))]
        open_walls |= {((r, c), chosen), (chosen, (r, c))}
        seen.add(chosen)
        path.append(chosen)
    walls = frame(_MAZE, t)
    for r in range(cells):
        for c in range(cells):
            top, left = r * step, c * step
            if c + 1 < cells and ((r, c), (r, c + 1)) not in open_walls:
                walls.append((left + step, top, left + step + t - 1, top + step + t - 1))
            if r + 1 < cells and ((r, c), (r + 1, c)) not in open_walls:
                walls.append((left, top + step, left + step + t - 1, top + step + t - 1))
    return plan(_MAZE, walls, [])


def flat(number: int) -> Image.Image:
    """A flat with rooms, doors and furniture; flat 2 is a mirror image with other furniture."""
    size, t = _FLAT, 4
    walls = [
        *frame(size, t),
        (0, 160, 240, 160 + t - 1),  # bedroom and bath above, hall below
        (160, 0, 160 + t - 1, 160),
        (240, 0, 240 + t - 1, 160),
        (0, 240, 160, 240 + t - 1),
        (160, 240, 160 + t - 1, size - 1),
        (240, 160, 240 + t - 1, 200),
    ]
    doors = [
        (104, 160, 138, 160 + t - 1),
        (186, 160, 220, 160 + t - 1),
        (104, 240, 138, 240 + t - 1),
        (160, 300, 160 + t - 1, 334),
    ]
    furniture = {
        1: [(10, 10, 60, 80), (176, 10, 226, 34), (290, 60, 340, 110), (20, 350, 90, 385), (330, 250, 385, 330)],
        2: [(10, 90, 70, 150), (170, 70, 190, 110), (320, 10, 385, 60), (100, 360, 150, 390), (260, 260, 300, 320)],
    }[number]
    image = plan(size, [*walls, *furniture], doors)
    return image if number == 1 else image.transpose(Image.Transpose.FLIP_LEFT_RIGHT)


def main(folder: Path) -> None:
    """Write all maps into a folder, as PNG files of two colours."""
    pictures = {"cave": cave(), "office": office(), "maze": maze(), "flat_1": flat(1), "flat_2": flat(2)}
    for name, picture in pictures.items():
        picture.convert("1", dither=Image.Dither.NONE).save(folder / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
