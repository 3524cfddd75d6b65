"""Scenes of splats that are tilted: the direction that points up is detected, and what ``--rotate`` does by hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import angles_of, axes_of, turn_between, turn_of
from irsim.bridges.maps.importing import import_map, list_levels, read_occupancy
from irsim.bridges.maps.sidecar import read_sidecar
from irsim.bridges.maps.source import ImportLimits, ImportOptions
from irsim.bridges.splats.reading import read_splats
from irsim.bridges.splats.upright import upward_of
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError
from tests.bridges.splats.scenes import room, turned, write_ply

UP = np.array([0.0, 0.0, 1.0])
HALL = room(spacing=0.1)


def tilts(count: int, greatest: float) -> list[np.ndarray]:
    """Rotations that tilt by up to so many degrees to all sides, of scenes that face any way."""
    rng = np.random.default_rng(32)
    sides, ways = rng.uniform(0, 2 * math.pi, (2, count))
    angles = np.radians(np.linspace(1.0, greatest, count))
    ends = [np.array([math.sin(a) * math.cos(s), math.sin(a) * math.sin(s), math.cos(a)])
            for a, s in zip(angles, sides, strict=True)]  # fmt: skip
    return [turn_between(UP, end) @ turn_of(0, 0, way) for end, way in zip(ends, ways, strict=True)]


def looks(kind: str) -> np.ndarray:
    """Columns of the hall as scenes come: splats that lie exactly, that lie and stand roughly, and round ones."""
    columns, rng = HALL.columns.copy(), np.random.default_rng(7)
    if kind == "round":
        columns[:, 10:13] = math.log(0.05)
    elif kind == "rough":
        columns[:, 13:17] += rng.normal(0, 0.1, (len(columns), 4))
        columns[:, :3] += rng.normal(0, 0.03, (len(columns), 3))
        columns[:, 10:13] += rng.normal(0, 0.4, (len(columns), 3))
    return columns


@pytest.mark.parametrize(("kind", "count"), [("exact", 30), ("rough", 30), ("round", 6)])
def test_tilts_up_to_forty_degrees_are_found_within_half_a_degree(kind: str, count: int) -> None:
    columns = looks(kind)
    for number, tilt in enumerate(tilts(count, 40.0)):
        scene = read_splats(write_ply(Path("a.ply"), turned(columns, tilt, np.array([1.0, -2.0, number / 10]))))
        turn = upward_of(scene, UP)
        assert turn is not None
        assert math.degrees(math.acos(min(1.0, float(turn.direction @ tilt @ UP)))) < 0.5
        assert turn.tilt == pytest.approx(1 + 39 * number / (count - 1), abs=0.5)


def plan_of(file: Path, **options) -> tuple[np.ndarray, float]:
    _, plan, _ = read_occupancy(file, ImportOptions(resolution=0.1, **options), ImportLimits())
    return plan.values, plan.height


@pytest.mark.parametrize("frame", ["irsim", "habitat_yup", "colmap"])
def test_the_map_of_a_tilted_scene_is_that_of_the_upright_one(frame: str) -> None:
    up = {"irsim": "z", "habitat_yup": "y", "colmap": "-y"}[frame]
    axes, shift = axes_of(frame), np.array([0.3, -0.2, 0.5])
    tilt = axes @ turn_of(math.radians(17), math.radians(-9), 0.0) @ axes.T
    straight = write_ply(Path("straight.ply"), turned(HALL.columns, axes, shift))
    tilted = write_ply(Path("tilted.ply"), turned(turned(HALL.columns, axes, shift), tilt, np.zeros(3)))
    before = import_map(straight, "straight.yaml", up=up, resolution=0.1)
    after = import_map(tilted, "tilted.yaml", up=up, resolution=0.1)
    assert not [note for note in before.notes if "tilted" in note]
    assert [note for note in after.notes if note.startswith("the scene is tilted by 19.") and "turned upright" in note]
    assert after.free_area == pytest.approx(before.free_area, rel=0.02)
    assert after.height == pytest.approx(before.height, abs=0.02)
    sidecar = read_sidecar("tilted.yaml")
    places = np.array([[1.0, 1.0, 0.0], [7.0, 5.0, 1.0], [2.0, 3.0, 2.0]])
    here = places @ axes.T + shift  # the same places of the straight scene, and of the tilted one
    apart = sidecar.to_irsim(here @ tilt.T) - read_sidecar("straight.yaml").to_irsim(here)
    assert np.abs(apart[:, 2]).max() < 0.02
    lengths = np.linalg.norm(np.diff(sidecar.to_irsim(here @ tilt.T), axis=0), axis=1)
    np.testing.assert_allclose(lengths, np.linalg.norm(np.diff(places, axis=0), axis=1), atol=1e-6)


def test_larger_tilts_are_turned_by_hand() -> None:
    turn = turn_of(math.radians(70), math.radians(20), math.radians(5))
    file = write_ply(Path("a.ply"), turned(HALL.columns, turn.T, np.zeros(3)))
    straight, _ = plan_of(write_ply(Path("b.ply"), HALL.columns))
    by_hand, height = plan_of(file, rotate=(70, 20, 5))
    np.testing.assert_array_equal(by_hand, straight)
    assert height == pytest.approx(0, abs=0.01)
    import_map(file, "a.yaml", rotate=(70, 20, 5))
    np.testing.assert_allclose(read_sidecar("a.yaml").T_scene_from_irsim[:3, :3], turn.T, atol=1e-9)
    roughly = list_levels(file, rotate=(72, 20, 5), resolution=0.1)
    [note] = [note for note in roughly.notes if "still tilted by" in note]
    words = note.partition("--rotate=")[2].split()[0]
    again = list_levels(file, rotate=tuple(map(float, words.split(","))), resolution=0.1)
    assert "tilted" not in " ".join(again.notes)
    assert again.free_area == pytest.approx(roughly.free_area, rel=0.1)


def test_the_command_says_what_it_did_and_leaves_scenes_alone_on_demand() -> None:
    write_ply(Path("a.ply"), turned(HALL.columns, turn_of(0.2, 0, 0), np.zeros(3)))
    words = ["map", "import", "a.ply", "-o", "a.yaml", "--force", "--resolution", "0.1"]
    shown = CliRunner().invoke(app, words)
    assert shown.exit_code == 0
    assert "the scene is tilted by 11.5°, and was turned upright, as by --rotate=-11.4" in shown.output.replace(
        "\n", " "
    )
    left = CliRunner().invoke(app, [*words, "--rotate", "0,0,0"])
    assert "still tilted by 11.5°" in left.output
    wrong = CliRunner().invoke(app, [*words, "--rotate", "0,0"])
    assert "the rotation '0,0' is not 3 numbers" in wrong.output
    Path("map.yaml").write_text("{image: x.pgm, resolution: 1, origin: [0, 0, 0]}")
    with pytest.raises(ArgumentError, match="the option rotate says nothing about"):
        import_map("map.yaml", "b.yaml", rotate=(0, 0, 1))


@pytest.mark.parametrize("count", [4, 50, 1000])
def test_splats_without_a_floor_have_no_direction(count: int) -> None:
    rng = np.random.default_rng(count)
    rows = HALL.columns[rng.choice(len(HALL.columns), count)].copy()
    rows[:, :3] = rng.normal(0, 1, (count, 3))
    rows[:, 13:17] = rng.normal(0, 1, (count, 4))
    file = write_ply(Path("a.ply"), rows)
    assert upward_of(read_splats(file), UP) is None
    with pytest.raises(BridgeError, match=r"no connected floor|no splat"):
        import_map(file, "a.yaml")


def test_angles_of_rotations() -> None:
    for angles in [(0.3, -0.2, 2.5), (-3.0, 1.2, -0.1), (0.0, math.pi / 2, 0.4), (0.0, -math.pi / 2, -1.0)]:
        np.testing.assert_allclose(turn_of(*angles_of(turn_of(*angles))), turn_of(*angles), atol=1e-12)
