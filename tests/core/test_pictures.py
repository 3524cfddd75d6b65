"""The painter draws what Agg draws; parts of pictures are put together exactly."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.path import Path
from matplotlib.transforms import Bbox, IdentityTransform

from irsim import _core as core

WIDTH, HEIGHT, DPI = 300, 200, 100.0
CLIP = (20, 15, 281, 180)  # of axes from 20.2 to 280.6 px, and from 20.3 to 184.7 px above the lower edge
GREEN, INK, NONE = (0.0, 0.6, 0.3, 0.5), (0.1, 0.1, 0.1, 1.0), (0.0, 0.0, 0.0, 0.0)
TURN = np.array([[math.cos(0.7), math.sin(0.7)], [-math.sin(0.7), math.cos(0.7)]])
ARROW = np.array([(0, -3), (30, -3), (30, -9), (51, 0), (30, 9), (30, 3), (0, 3)]) @ TURN + (100, 60)
SQUARE = np.array([(50.3, 60.2), (110.6, 60.2), (110.6, 90.7), (50.3, 90.7)])
BEYOND = np.array([(-40.0, 50.3), (150.7, -60.0), (400.0, 120.0), (90.2, 320.0)])
POLYGONS = {"arrow": ARROW, "square": SQUARE, "beyond the axes": BEYOND}


def agg(draw: Callable[[Any, Any], None]) -> np.ndarray:
    new: Any = RendererAgg
    renderer = new(WIDTH, HEIGHT, DPI)
    pixels = np.asarray(renderer.buffer_rgba())
    pixels[...] = 255
    context = renderer.new_gc()
    context.set_clip_rectangle(Bbox([[20.2, 20.3], [280.6, 184.7]]))
    draw(renderer, context)
    return pixels.copy()


def agg_path(path: Path, face: Any, edge: Any, width: float, join: str = "miter", cap: str = "butt") -> np.ndarray:
    def draw(renderer: Any, context: Any) -> None:
        context.set_capstyle(cap)
        context.set_joinstyle(join)
        context.set_foreground(edge, isRGBA=True)
        context.set_linewidth(width * 72 / DPI)
        renderer.draw_path(context, path, IdentityTransform(), face)

    return agg(draw)


def painted(paint: Callable[[core.Painter, np.ndarray], None]) -> np.ndarray:
    pixels = np.full((HEIGHT, WIDTH, 4), 255, np.uint8)
    painter = core.Painter((WIDTH, HEIGHT), CLIP, (1, 0, 0, 0, -1, HEIGHT))
    paint(painter, pixels)
    boxes = painter.take_boxes()
    untouched = np.ones((HEIGHT, WIDTH), bool)
    for left, top, right, bottom in boxes:
        untouched[top:bottom, left:right] = False
    assert (pixels[untouched] == 255).all()  # all that was painted lies within the boxes
    return pixels


def shape(
    painter: core.Painter, pixels: np.ndarray, points: np.ndarray, fill: Any, edge: Any, width: float, **how: Any
) -> None:
    """Paint one shape: the circle of a ``radius``, a polygon if it is ``closed``, else a line."""
    style = {"closed": True, "join": "miter", "round_caps": False, **how}
    radius = style.pop("radius", -1.0)
    inks = (np.array([[fill, edge]]) * 255 + 0.5).astype(np.uint8)
    painter.shapes(
        pixels, points, np.array([[0, len(points)]]), np.array([radius]), inks, np.array([width]), **style
    )  # fmt: skip


def closed(points: np.ndarray) -> Path:
    codes = [Path.MOVETO, *[Path.LINETO] * (len(points) - 1), Path.CLOSEPOLY]
    return Path(np.concatenate([points, points[:1]]), codes)


def assert_alike(first: np.ndarray, second: np.ndarray, most: int, few: float) -> None:
    """At no pixel do they differ by more than ``most`` levels, and by more than 8 at few of the drawn ones."""
    apart = np.abs(first.astype(int) - second.astype(int)).max(axis=2)
    drawn = (first != 255).any(axis=2).sum()
    assert drawn > 0
    assert apart.max() <= most
    assert (apart > 8).sum() <= few * drawn


@pytest.mark.parametrize("width", [1.0, 1.39, 5.0])
@pytest.mark.parametrize(
    "place", [(100.3, 120.7, 17.2), (150.0, 100.0, 60.5), (25.0, 25.0, 20.0), (275.5, 170.1, 30.0)]
)
def test_a_circle_is_that_of_agg(place: tuple[float, float, float], width: float) -> None:
    x, y, radius = place
    unit = Path.unit_circle()
    path = Path(np.asarray(unit.vertices) * radius + (x, y), unit.codes)
    mine = painted(lambda painter, pixels: shape(painter, pixels, np.array([(x, y)]), GREEN, INK, width, radius=radius))
    # Agg turns a circle into few straight pieces, up to a tenth of a pixel beside it.
    assert_alike(agg_path(path, GREEN, INK, width), mine, 40, 0.1)


@pytest.mark.parametrize("join", ["miter", "round", "bevel"])
@pytest.mark.parametrize("width", [1.0, 1.39, 6.3])
@pytest.mark.parametrize("name", POLYGONS)
def test_a_polygon_is_that_of_agg(name: str, width: float, join: str) -> None:
    points = POLYGONS[name]
    mine = painted(lambda painter, pixels: shape(painter, pixels, points, GREEN, INK, width, join=join))
    assert_alike(agg_path(closed(points), GREEN, INK, width, join), mine, 60, 0.06)


@pytest.mark.parametrize("round_caps", [True, False])
@pytest.mark.parametrize("width", [1.39, 5.0, 30.0])
def test_a_line_is_that_of_agg(width: float, round_caps: bool) -> None:
    along = np.linspace(0, 5, 60)
    points = np.stack([60 + 35 * along, 100 + 40 * np.sin(along)], axis=1)
    how = {"closed": False, "join": "round", "round_caps": round_caps}
    mine = painted(lambda painter, pixels: shape(painter, pixels, points, NONE, GREEN, width, **how))
    assert_alike(agg_path(Path(points), None, GREEN, width, "round", "round" if round_caps else "butt"), mine, 60, 0.02)


def test_beams_are_those_of_agg() -> None:
    angles = np.linspace(0, math.tau, 90)  # some run along the axes of the picture
    ends = np.stack([150.3 + 170 * np.cos(angles), 100.2 + 170 * np.sin(angles)], axis=1)

    def draw(renderer: Any, context: Any) -> None:
        context.set_foreground((0.8, 0.1, 0.0, 0.3), isRGBA=True)
        context.set_linewidth(1.0)
        context.set_capstyle("butt")
        for end in ends:
            renderer.draw_path(context, Path([(150.3, 100.2), end]), IdentityTransform())

    inks, widths = np.tile(np.array([204, 26, 0, 77], np.uint8), (90, 1)), np.full(90, DPI / 72)
    mine = painted(lambda painter, pixels: painter.beams(pixels, (150.3, 100.2), ends, inks, widths))
    assert np.abs(agg(draw).astype(int) - mine).max() <= 10  # rounded once for each of the beams that meet


def test_a_shape_that_is_not_finite_is_left_out() -> None:
    line = np.array([(50.0, 50.0), (math.nan, 80.0), (math.inf, 90.0)])

    def paint(painter: core.Painter, pixels: np.ndarray) -> None:
        for points in (line, np.full((3, 2), math.nan), line[:1], line[:0]):
            shape(painter, pixels, points, NONE, INK, 2.0, closed=False, join="round", round_caps=True)
            shape(painter, pixels, points, INK, INK, 2.0)

    painted(paint)
    lost, near = np.array([(math.nan, 5.0)]), np.array([(50.0, 50.0)])
    painted(lambda painter, pixels: shape(painter, pixels, lost, INK, INK, 1.0, radius=3.0))
    painted(lambda painter, pixels: shape(painter, pixels, near, NONE, INK, 1.0, radius=1e7))


def test_shapes_of_one_call_cover_one_another_in_their_order() -> None:
    points = np.concatenate([ARROW, [(100.0, 60.0)], SQUARE])
    ranges = np.array([(0, 7), (7, 8), (8, 12), (8, 8)])
    radii, widths = np.array([-1.0, 15.0, -1.0, -1.0]), np.array([2.0, 0.0, 3.0, 1.0])
    looks = [(GREEN, INK), (INK, NONE), (GREEN, INK), (INK, INK)]
    inks = (np.array(looks) * 255 + 0.5).astype(np.uint8)
    together = painted(lambda p, pixels: p.shapes(pixels, points, ranges, radii, inks, widths, True, "miter", False))

    def one_by_one(painter: core.Painter, pixels: np.ndarray) -> None:
        for (begin, end), radius, (fill, edge), width in zip(ranges, radii, looks, widths, strict=True):
            shape(painter, pixels, points[begin:end], fill, edge, width, radius=radius)

    assert (together == painted(one_by_one)).all()
    assert together[HEIGHT - 60, 100, :3].tolist() != [255, 255, 255]


def test_shapes_whose_arrays_disagree_are_refused() -> None:
    painter, pixels = core.Painter((5, 4), (0, 0, 5, 4), (1, 0, 0, 0, -1, 4)), np.zeros((4, 5, 4), np.uint8)
    one, inks = np.ones(1), np.zeros((1, 2, 4), np.uint8)
    for ranges, message in (((0, 3), "within the points"), ((2, 1), "within the points"), ((-1, 1), "within")):
        with pytest.raises(ValueError, match=message):
            painter.shapes(pixels, np.zeros((2, 2)), np.array([ranges]), one, inks, one, True, "miter", False)
    with pytest.raises(ValueError, match="one radius"):
        painter.shapes(pixels, np.zeros((2, 2)), np.array([(0, 1)]), np.ones(2), inks, one, True, "miter", False)
    with pytest.raises(ValueError, match="dashes and gaps"):
        painter.shapes(pixels, np.zeros((2, 2)), np.array([(0, 1)]), one, inks, one, False, "miter", False, [1.0])


NAMES = {
    "height": 10.0, "inside": (0.0, 0.0, 300.0, 200.0), "taken": np.empty((0, 4)), "walls": np.empty((0, 4)),
    "plans": np.empty((0, 2)), "plan_ranges": np.empty((0, 2), np.int64), "trails": np.empty((0, 2)),
}  # fmt: skip
THING = (150.0, 100.0, 8.0, 8.0, 40.0)
ABOVE, BELOW = (130.0, 112.0, 170.0, 122.0), (130.0, 78.0, 170.0, 88.0)


def test_a_name_stands_above_its_thing_unless_something_is_there() -> None:
    def place(**around: Any) -> tuple[float, ...]:
        return core.place_names(np.array([THING]), **{**NAMES, **around})[0]

    assert place() == (0, *ABOVE)
    assert place(taken=np.array([(120.0, 121.0, 135.0, 140.0)])) == (1, *BELOW)
    assert place(walls=np.array([(120.0, 121.0, 135.0, 140.0)])) == (1, *BELOW)
    assert place(walls=np.array([(0.0, 0.0, 300.0, 200.0)])) == (0, *ABOVE), "everything is over a wall"
    crossing = {"plans": np.array([(140.0, 0.0), (140.0, 95.0), (150.0, 190.0)]), "plan_ranges": np.array([(0, 3)])}
    assert place(**crossing)[0] == 2, "right of the thing, as a line runs above and below it"
    assert place(trails=np.array([(131.0, 113.0)]))[0] == 1
    assert place(inside=(140.0, 90.0, 300.0, 111.0))[0] == 2
    assert place(inside=(0.0, 0.0, 30.0, 30.0))[0] == -1


def test_names_avoid_one_another_and_move_away_where_it_is_crowded() -> None:
    placed = core.place_names(np.array([THING] * 20), **NAMES)
    numbers = [number for number, *_ in placed if number >= 0]
    assert numbers == sorted(numbers)
    assert [number for number, *_ in placed[len(numbers) :]] == [-1] * (20 - len(numbers))
    boxes = [box for number, *box in placed if number >= 0]
    assert len(boxes) > 8
    assert not any(a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3] for a, b in combinations(boxes, 2))


def test_boxes_of_change() -> None:
    rng = np.random.default_rng(3)
    before = rng.integers(0, 256, (40, 50, 4), dtype=np.uint8)
    after = before.copy()
    assert core.changed_box(before, after) is None
    after[12, 30, 2] ^= 1
    after[20, 7, 0] ^= 1
    assert core.changed_box(before, after) == (7, 12, 31, 21)
    assert core.changed_box(before, after, [(25, 10, 35, 15), (26, 11, 36, 16)]) == (30, 12, 31, 13)
    target = before.copy()
    core.copy_boxes(after, target, [(7, 12, 31, 21)])
    assert (target == after).all()


def test_layers_are_laid_over_the_ground() -> None:
    ground = np.full((20, 30, 4), 200, np.uint8)
    ground[..., 3] = 255
    mask, image = np.zeros((6, 8), np.uint8), np.zeros((5, 5, 4), np.uint8)
    mask[2:4, 2:6] = 255
    image[1:3, 1:3] = (10, 20, 30, 128)
    pixels = ground.copy()
    layers = [(mask, 4, 3, (100.0, 0.0, 50.0), 0.5), (image, 20, 10, (0.0, 0.0, 0.0), 1.0)]
    core.compose(pixels, ground, [(0, 0, 15, 20), (14, 0, 30, 20)], layers)
    assert pixels[5, 6].tolist() == [150, 100, 125, 255]
    assert pixels[11, 21, :3].tolist() == pytest.approx([105, 110, 115], abs=1)
    changed = np.argwhere((pixels != ground).any(axis=2))
    assert len(changed) == 8 + 4


def test_pictures_of_other_sizes_are_refused() -> None:
    small, large = np.zeros((4, 5, 4), np.uint8), np.zeros((5, 5, 4), np.uint8)
    painter = core.Painter((5, 4), (0, 0, 5, 4), (1, 0, 0, 0, -1, 4))
    with pytest.raises(ValueError, match="size"):
        shape(painter, large, np.ones((1, 2)), INK, INK, 1.0, radius=1.0)
    with pytest.raises(ValueError, match="size"):
        core.changed_box(small, large)
    with pytest.raises(ValueError, match="size"):
        core.compose(small, large, [], [])
    with pytest.raises(ValueError, match="clip box"):
        core.Painter((5, 4), (0, 0, 6, 4), (1, 0, 0, 0, -1, 4))
    with pytest.raises(ValueError, match="side by side"):
        core.rgb_rows(np.zeros((4, 10, 4), np.uint8)[:, ::2])
