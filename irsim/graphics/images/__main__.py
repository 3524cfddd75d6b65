"""Draw the bundled pictures (``python -m irsim.graphics.images``): cars and round robots from above, facing right."""

from __future__ import annotations

from pathlib import Path

from PIL import Image, ImageDraw

Rgb = tuple[int, int, int]

_OVERSAMPLING = 4
"""Pictures are drawn this many times larger and then reduced, for smooth edges."""
_CARS: dict[str, Rgb] = {"car_green.png": (0, 158, 115), "car_blue.png": (0, 114, 178), "car_red.png": (204, 51, 17)}
_ROBOTS: dict[str, Rgb] = {"diff_robot0.png": (0, 158, 115), "diff_robot1.png": (230, 159, 0)}
_TYRE: Rgb = (35, 38, 42)
_GLASS: Rgb = (52, 70, 84)
_LAMP: Rgb = (255, 236, 160)
_BRAKE: Rgb = (150, 20, 20)


def shade(color: Rgb, factor: float) -> Rgb:
    """Make a colour darker (factor below 1) or lighter (above 1)."""
    red, green, blue = (min(255, round(level * factor)) for level in color)
    return red, green, blue


def car(color: Rgb, width: int = 368, height: int = 160) -> Image.Image:
    """Draw a car whose body fills the picture."""
    image, pen, u = _canvas(width, height)

    def box(x0: float, y0: float, x1: float, y1: float, radius: float, fill: Rgb) -> None:
        pen.rounded_rectangle((x0 * u, y0 * u, x1 * u, y1 * u), radius * u, fill=fill)

    for x in (52, 260):
        box(x, 0, x + 58, 22, 6, _TYRE)
        box(x, height - 22, x + 58, height, 6, _TYRE)
    box(0, 8, width, height - 8, 44, shade(color, 0.72))
    box(4, 12, width - 4, height - 12, 40, color)
    pen.polygon(
        [(p * u, q * u) for p, q in ((214, 26), (262, 38), (262, height - 38), (214, height - 26))], fill=_GLASS
    )
    pen.polygon([(p * u, q * u) for p, q in ((92, 28), (58, 40), (58, height - 40), (92, height - 28))], fill=_GLASS)
    for y in (21, height - 29):
        pen.polygon([(p * u, q * u) for p, q in ((104, y), (202, y), (196, y + 8), (110, y + 8))], fill=_GLASS)
    box(98, 34, 208, height - 34, 14, shade(color, 1.18))
    for y in (24, height - 46):
        box(width - 22, y, width - 5, y + 22, 7, _LAMP)
        box(5, y, 15, y + 22, 4, _BRAKE)
    return image.resize((width, height), Image.Resampling.LANCZOS)


def round_robot(color: Rgb, size: int = 200) -> Image.Image:
    """Draw a disc on two wheels with a sensor; a dark wedge marks the front."""
    image, pen, u = _canvas(size, size)
    middle = size / 2

    def disc(x: float, y: float, radius: float, fill: Rgb) -> None:
        pen.ellipse(((x - radius) * u, (y - radius) * u, (x + radius) * u, (y + radius) * u), fill=fill)

    disc(middle, middle, middle, shade(color, 0.66))
    disc(middle, middle, middle - 5, color)
    for y in (10, size - 34):
        pen.rounded_rectangle(((middle - 34) * u, y * u, (middle + 34) * u, (y + 24) * u), 8 * u, fill=_TYRE)
    bow = ((middle - 78) * u, (middle - 78) * u, (middle + 78) * u, (middle + 78) * u)
    pen.pieslice(bow, -28, 28, fill=_GLASS)
    disc(middle, middle, 44, shade(color, 0.66))
    disc(middle, middle, 34, (238, 240, 242))
    disc(middle, middle, 10, _TYRE)
    return image.resize((size, size), Image.Resampling.LANCZOS)


def _canvas(width: int, height: int) -> tuple[Image.Image, ImageDraw.ImageDraw, int]:
    image = Image.new("RGBA", (width * _OVERSAMPLING, height * _OVERSAMPLING), (255, 255, 255, 0))
    return image, ImageDraw.Draw(image), _OVERSAMPLING


def main(folder: Path = Path(__file__).parent) -> None:
    """Write all pictures."""
    for name, color in _CARS.items():
        car(color).save(folder / name, optimize=True)
    for name, color in _ROBOTS.items():
        round_robot(color).save(folder / name, optimize=True)


if __name__ == "__main__":
    main()
