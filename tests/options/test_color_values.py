"""Colors as numbers are as matplotlib draws them, and most need no drawing library."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest
from matplotlib.colors import to_rgb
from PIL.ImageColor import getrgb

from irsim.options.colors import CYCLE, NAMES, rgb

OTHERS = ("#abc", "#abcd", "#12aBcD", "#12345678", "0", "1", "0.25", ".5", "1.", "C0", "C7", "C12", "xkcd:sky blue")


@pytest.mark.parametrize("color", [*NAMES, *CYCLE, *OTHERS, (0.1, 0.2, 0.3), (0.1, 0.2, 0.3, 0.4)])
def test_a_color_is_the_one_that_is_drawn(color: Any) -> None:
    assert rgb(color) == pytest.approx(to_rgb(color), abs=1e-12)


def test_names_may_have_capital_letters_and_are_the_same_when_read_again() -> None:
    assert rgb("SteelBlue") == rgb("steelblue")
    assert rgb("teal") == rgb("teal") == tuple(value / 255 for value in getrgb("teal"))


@pytest.mark.parametrize("color", ["#12", "#xyzxyz", "nocolor", "C", "1.2.3"])
def test_what_is_no_color(color: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        rgb(color)


def test_the_usual_ones_do_not_load_a_drawing_library() -> None:
    program = (
        "import sys; from irsim.options.colors import rgb; from irsim.options.colors import NAMES\n"
        "for name in (*NAMES, 'C3', '#123456', '0.5'): rgb(name)\n"
        "sys.exit('matplotlib' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
