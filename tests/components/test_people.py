"""Options fitted to recorded people: ``people`` of a behavior."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

import irsim
from irsim.bridges.pedestrians.cases import read_cases
from irsim.components.behaviors._people import FITTED, People
from irsim.options.registry import BEHAVIORS
from tests.benchmarks.pedestrians.fit import BOUNDS, fit
from tests.benchmarks.pedestrians.fitted import NOT_SHIPPED
from tests.benchmarks.pedestrians.human import FILES

SCENE = """
world: {{width: 20, height: 10, collision_mode: unobstructed}}
robot:
  - {{kinematics: {{name: omni}}, state: [1, 5, 0], goal: [19, 5], behavior: {0}, shape: {{name: circle, radius: 0.2}}}}
obstacle:
  - kinematics: {{name: omni}}
    state: [19, 5.2, 0]
    goal: [1, 5]
    shape: {{name: circle, radius: 0.2}}
    behavior: {0}
"""


def options_of(behavior: dict[str, Any]) -> Any:
    feature = BEHAVIORS.get(behavior["name"])
    assert feature is not None
    return feature.options.model_validate(behavior)


def way(folder: Path, behavior: str) -> list[list[float]]:
    """Places of the robot of the scene at the end of each step."""
    scene = folder / "scene.yaml"
    scene.write_text(SCENE.format(behavior))
    env = irsim.make(str(scene), headless=True, log_level="ERROR")
    places = []
    for _ in range(80):
        env.step()
        places.append(env.robot_list[0].state[:2, 0].tolist())
    return places


@pytest.mark.parametrize("name", FITTED)
@pytest.mark.parametrize("people", get_args(People))
def test_every_set_has_the_options_that_are_fitted(name: str, people: str) -> None:
    assert set(FITTED[name]) == set(get_args(People))
    options = options_of({"name": name, "people": people})
    assert {key: getattr(options, key) for key in BOUNDS[name]} == FITTED[name][people]


def test_keys_beside_it_win_and_others_keep_their_defaults() -> None:
    options, plain = options_of({"name": "sfm", "people": "eth", "gamma": 0.2}), options_of({"name": "sfm"})
    assert (options.gamma, options.n_angular) == (0.2, FITTED["sfm"]["eth"]["n_angular"])
    assert (options.vmax, options.sigma_obstacle) == (plain.vmax, plain.sigma_obstacle)
    assert options_of({"name": "sfm", "people": None}) == plain


@pytest.mark.parametrize("name", FITTED)
def test_people_walk_as_with_the_options_written_out(tmp_path: Path, name: str) -> None:
    written = ", ".join(f"{key}: {value}" for key, value in FITTED[name]["eth"].items())
    fitted = way(tmp_path, f"{{name: {name}, people: eth}}")
    assert fitted == way(tmp_path, f"{{name: {name}, {written}}}")
    assert np.abs(np.array(fitted) - way(tmp_path, f"{{name: {name}}}")).max() > 0.01


@pytest.mark.parametrize(("people", "fix"), [("etj", "people: eth"), ("[eth]", None), ("3", None)])
def test_people_that_there_are_none_of(people: str, fix: str | None) -> None:
    findings = irsim.validate(text=SCENE.format(f"{{name: orca, people: {people}}}")).findings
    first = next(item for item in findings if item.severity == "error")
    assert first.path == "robot[0].behavior.people"
    assert "eth" in str(first.allowed) or fix is None
    assert first.fix == fix or fix is None


@pytest.mark.foreign
def test_a_search_in_hotel_finds_the_same_options_again(foreign: Path) -> None:
    assert fit(read_cases(foreign / "pedestrians" / FILES["hotel"]), "orca") == NOT_SHIPPED["orca"]
