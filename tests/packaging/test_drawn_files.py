"""The programs beside the bundled pictures draw the same pictures again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.components.maps._data import __main__ as maps
from irsim.graphics.images import __main__ as images

PACKAGE = Path(irsim.__file__).parent


@pytest.mark.parametrize(
    ("draw", "folder", "levels"),
    [(maps.main, PACKAGE / "components/maps/_data", 0), (images.main, PACKAGE / "graphics/images", 2)],
    ids=["maps", "images"],
)
def test_bundled_pictures_are_as_their_program_draws_them(
    draw: Callable[[Path], None], folder: Path, levels: int, tmp_path: Path
) -> None:
    draw(tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names
    assert names == {path.name for path in folder.glob("*.png")}
    for name in names:
        drawn, kept = (np.asarray(Image.open(place / name).convert("RGBA")).astype(int) for place in (tmp_path, folder))
        assert drawn.shape == kept.shape
        assert np.abs(drawn - kept).max() <= levels, name
