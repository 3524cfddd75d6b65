"""Files of the map server as other programs write them: numbers, modes, tabs, and pictures of other computers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from irsim.bridges.maps import import_map
from irsim.components.maps._rosmap import read_meta
from irsim.scenario.limits import Limits
from irsim.scenario.read import Reading, read

FIELD = Path(__file__).parent / "field"
STANDARD = {"image": "map.pgm", "resolution": "0.05", "origin": "[-1.0, 2.0, 0.0]", "negate": "0"}


def written(folder: Path, **keys: str) -> Path:
    """A map whose values are the texts given."""
    Image.fromarray(np.full((4, 6), 254, np.uint8)).save(folder / "map.pgm")
    file = folder / "map.yaml"
    file.write_text("".join(f"{key}: {value}\n" for key, value in {**STANDARD, **keys}.items()))
    return file


def reading_of(file: Path, limits: Limits | None = None) -> Reading:
    scenario = file.with_name("s.yaml")
    scenario.write_text("world: {obstacle_map: {name: ros, path: map.yaml}}\n")
    return read(scenario) if limits is None else read(scenario, limits=limits)


def test_an_exponent_needs_no_point() -> None:
    meta = read_meta(FIELD / "M04_yamlcpp_exponent.yaml", "M04")
    assert meta.origin == (-2.0, -1.5, 1e-5)


@pytest.mark.parametrize(
    ("key", "text", "attribute", "value"),
    [
        ("resolution", "5e-2", "resolution", 0.05),
        ("resolution", '"0.05"', "resolution", 0.05),
        ("resolution", "'.05'", "resolution", 0.05),
        ("negate", "'0'", "negate", False),
        ("negate", "true", "negate", True),
        ("trinary", "false", "mode", "scale"),
        ("trinary", "'true'", "mode", "trinary"),
        ("mode", "Trinary", "mode", "trinary"),
        ("mode", "RAW", "mode", "raw"),
        ("origin", "[-1, 2, -nan]", "origin", (-1.0, 2.0, 0.0)),
        ("origin", "[-1, 2, .nan]", "origin", (-1.0, 2.0, 0.0)),
        ("origin", "\t[-1,\t2,\t1e-05]", "origin", (-1.0, 2.0, 1e-5)),
    ],
)
def test_values_are_read_as_ros_reads_them(tmp_path, key, text, attribute, value) -> None:
    meta = read_meta(written(tmp_path, **{key: text}), "map.yaml")
    assert getattr(meta, attribute) == value
    assert bool(meta.remarks) == ("nan" in text)


@pytest.mark.parametrize("text", ["five", "[1]", "2024-01-01", ".inf", "1e999"])
def test_other_values_are_refused_by_name(tmp_path, text) -> None:
    [problem] = reading_of(written(tmp_path, origin=f"[0, {text}]")).diagnostics
    assert (problem.code, "origin" in problem.message) == ("map-unreadable", True)


@pytest.mark.parametrize(
    "image", ["/home/someone/maps/map.pgm", "C:\\maps\\map.pgm", "maps\\map.pgm", "D:/maps/map.pgm"]
)
@pytest.mark.parametrize("confined", [False, True])
def test_a_picture_of_another_computer_is_taken_from_beside(tmp_path, image, confined) -> None:
    file = written(tmp_path, image=image)
    [note] = [
        one
        for one in reading_of(file, Limits(root=str(tmp_path)) if confined else None).diagnostics
        if one.code != "map-empty"
    ]
    assert (note.code, note.severity) == ("map-read-as", "hint")
    assert "'map.pgm' beside" in note.message
    result = import_map(file, tmp_path / "out.yaml")
    assert any("'map.pgm' beside" in one for one in result.notes)
