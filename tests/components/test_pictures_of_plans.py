"""Pictures that leave something open: thin walls, transparency, pixels that are not square, grey, wrong names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from irsim.objects.describe import grid_values
from irsim.scenario.read import read
from irsim.simulation.simulation import Simulation

FIELD = Path(__file__).parent / "field"


def test_a_thin_wall_stays() -> None:
    scenario = read(FIELD / "M03b_mdownsample.yaml").scenario
    walls = scenario.grid.cells.occupied
    assert walls[int(15.1 / scenario.grid.cell[0])].all()


def test_noise_of_each_scene_is_merged_as_a_picture_is() -> None:
    share = []
    for merge in (1, 4):
        noise = {"name": "perlin", "resolution": 0.1, "fill": 0.2}
        scenario = read({"world": {"seed": 1, "mdownsample": merge, "obstacle_map": noise}}).scenario
        share.append(grid_values(Simulation(scenario, [1])))
    blocks = share[0].reshape(25, 4, 25, 4).max(axis=(1, 3))
    assert (blocks == share[1]).all()


def test_what_is_transparent_is_free_and_said() -> None:
    reading = read(FIELD / "M03a_transparent.yaml")
    [warning] = [one for one in reading.diagnostics if one.code == "map-transparent"]
    assert (warning.severity, "64.0%" in warning.message) == ("warning", True)
    assert reading.scenario.grid.cells.occupied.mean() < 0.4


def test_pixels_that_are_not_square_and_grey_ones_are_said(tmp_path) -> None:
    pixels = np.full((10, 20), 255, np.uint8)
    pixels[0], pixels[1] = 0, 120
    Image.fromarray(pixels).save(tmp_path / "plan.png")
    reading = read({"world": {"obstacle_map": str(tmp_path / "plan.png")}})
    [said] = (one.message for one in reading.diagnostics if one.code == "map-read-as")
    assert "0.5 x 1 m; its top row lies at the largest y" in said
    assert "10% of its pixels are grey" in said


def test_a_missing_picture_says_where_it_was_looked_for(tmp_path) -> None:
    scenario = tmp_path / "s.yaml"
    scenario.write_text("world: {obstacle_map: floor_1.png}\n")
    [problem] = read(scenario).diagnostics
    assert str(tmp_path) in problem.message
    assert "path:" not in problem.fix
    scenario.write_text("world: {obstacle_map: ofice.png}\n")
    [problem] = read(scenario).diagnostics
    assert problem.fix == "path: office.png"
