"""OBJ files of worlds and models, which are read without a library."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.kinds._named_meshes import read_obj
from irsim.bridges.maps.source import ImportLimits

_CORNERS = "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\nv 0 1 0\n"


def _read(text: str) -> np.ndarray:
    Path("a.obj").write_text(text)
    return read_obj(Path("a.obj"), ImportLimits(triangles=4))


@pytest.mark.parametrize("face", ["f 1 2 3 4", "f 1/1/1 2//1 3/1 4", "f -4 -3 -2 -1", "f 1 2 \\\n3 4"])
def test_faces_become_fans(face) -> None:
    expected = [[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]]
    np.testing.assert_array_equal(_read(f"# made\nmtllib ../../x.mtl\no a\n{_CORNERS}{face}\n"), expected)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (_CORNERS, "no triangles"),
        (f"{_CORNERS}f 1 2 9", "a corner that it does not have"),
        (f"{_CORNERS}f 1 2 0", "a corner that it does not have"),
        (f"{_CORNERS}f 1 2 -9", "a corner that it does not have"),
        (f"{_CORNERS}f 1 2 x", "line 5 is 'f 1 2 x'"),
        ("v 1 2\n", "line 1 is 'v 1 2'"),
        ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "not numbers"),
        (_CORNERS + "f 1 2 3\n" * 5, "more than 4 triangles"),
    ],
)
def test_damaged_files_are_refused(text, message) -> None:
    with pytest.raises(BridgeError, match=message):
        _read(text)
