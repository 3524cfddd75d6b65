"""Perturbations as users write them: text, mappings, units; for whom they count; what is wrong, all at once."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.diagnostics.errors import InputError
from irsim.scenario.open import read_scenario
from irsim.scenario.perturbation import (
    Perturbation,
    perturbation_text,
    perturbed,
    perturbed_message,
    read_perturbations,
)
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ResolvedScenario, Spreads, random_parts

SCENE = """
world: {name: hall, width: 10, height: 10, boundary: walls}
robot:
  - {name: scout, kinematics: {name: diff}, state: [1, 1], goal: [9, 9], behavior: {name: dash}, tags: [fast]}
  - {name: car, kinematics: {name: acker}, state: [1, 5], goal: [9, 5], behavior: {name: dash}}
  - {number: 2, kinematics: {name: omni}, distribution: {name: random}, shape: {name: circle, radius: 0.1}}
obstacle:
  - {name: walker, kinematics: {name: omni}, state: [5, 8], goal: [5, 1], behavior: {name: sfm}, tags: [pedestrian]}
  - {name: post, shape: {name: circle, radius: 0.3}, state: [5, 5], tags: [furniture]}
  - {name: crate, mass: 3, shape: {name: circle, radius: 0.3}, state: [8, 2]}
"""


@pytest.fixture(scope="module")
def hall() -> ResolvedScenario:
    return read_scenario(text=SCENE, strict=True)[0]


def spreads(scenario: ResolvedScenario, given: object) -> dict[str, Spreads]:
    """Spreads of the objects that have some, by name."""
    records = perturbed(scenario, read_perturbations(given)).objects
    return {record.name: record.spreads for record in records if record.spreads is not None}


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ("position=0.1", "position=0.1"),
        ("position=5cm, heading=10deg", "position=0.05,heading=0.174532925199"),
        ("heading=pi/8", "heading=0.392699081699"),
        ("speed=10%", "speed=0.1"),
        ("delay=1500 ms,objects=a, b", "delay=1.5,objects=a,b"),
        ({"position": 0.1, "objects": "a"}, "position=0.1,objects=a"),
        ({"heading": "10deg"}, "heading=0.174532925199"),
        ("{position: 0.2, objects: ['a,b']}", "{position: 0.2, objects: ['a,b']}"),
        (Perturbation(delay=2), "delay=2"),
    ],
)
def test_what_can_be_given(given: object, text: str) -> None:
    [perturbation] = read_perturbations(given)
    assert perturbation_text(perturbation) == text
    assert read_perturbations(text) == (perturbation,)


def test_several_in_a_list_or_in_one_text() -> None:
    pair = read_perturbations(["position=0.1", {"delay": 2, "objects": ["walker"]}])
    assert read_perturbations("position=0.1; delay=2,objects=walker") == pair
    assert read_perturbations(None) == ()


@given(
    values=st.dictionaries(st.sampled_from(["position", "delay"]), st.floats(0, 1e3), min_size=1),
    speed=st.floats(0, 0.99),
    heading=st.floats(0, 3.14),
    objects=st.none()
    | st.lists(st.text(st.characters(max_codepoint=0x2FF), min_size=1, max_size=8), min_size=1, max_size=3),
)
def test_the_text_of_a_perturbation_means_the_same(values, speed: float, heading: float, objects) -> None:
    [perturbation] = read_perturbations({**values, "speed": speed, "heading": heading, "objects": objects})
    assert read_perturbations(perturbation_text(perturbation)) == (perturbation,)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("position", ["'position' is not key=value"]),
        ("", ["'' is not key=value"]),
        ("posiion=1,speed=2", ["'posiion' is not a key of perturb, did you mean position?", "speed must be a share"]),
        ("heading=10", ["heading must be a number from 0 to 3.1416 [rad], got '10' (10 degrees are 10deg)"]),
        ("position=-1", ["position must be a number ≥ 0 [m], got '-1'"]),
        ("delay=soon", ["delay must be a number from 0 to 100000 [s], got 'soon'"]),
        ("delay=1e9", ["delay must be a number from 0 to 100000 [s], got '1e9'"]),
        ("position=1,position=2", ["position is given twice"]),
        ({"position": float("nan")}, ["position must be"]),
        ({"position": True}, ["position must be"]),
        ({"objects": ["scout"]}, ["has no spread"]),
        (["position=1", "speed=1"], ["perturb[1]: speed must be"]),
        ("{position: [", ["is not a mapping"]),
        (3, ["3 is not a perturbation"]),
        ([3], ["3 is not a perturbation"]),
    ],
)
def test_everything_that_is_wrong_is_said_at_once(given: object, words: list[str]) -> None:
    with pytest.raises(InputError) as error:
        read_perturbations(given)
    assert (error.value.where, error.value.code) == ("perturb", "bad-argument")
    assert "position=0.1" in str(error.value.fix)
    for text in words:
        assert text in error.value.message


def test_everybody_that_can_move(hall: ResolvedScenario) -> None:
    """Static objects, the walls round the world and random starts stay; what has no drive has no speed and no delay."""
    everything, drawn = Spreads(0.1, 0.0, 0.2, 3.0), Spreads(speed=0.2, delay=3.0)
    expected = dict.fromkeys(("scout", "car", "walker"), everything) | {"crate": Spreads(0.1)}
    expected |= dict.fromkeys(("robot_2", "robot_3"), drawn)
    assert spreads(hall, "position=0.1,speed=0.2,delay=3") == expected


@pytest.mark.parametrize(
    ("objects", "names"),
    [
        ("scout", {"scout"}),
        ("pedestrian", {"walker"}),
        ("robot", {"scout", "car"}),
        ("obstacle", {"walker", "crate"}),
        ("obstacle,post", {"walker", "crate", "post"}),
        ("furniture,fast", {"scout", "post"}),
    ],
)
def test_by_name_tag_and_role(hall: ResolvedScenario, objects: str, names: set[str]) -> None:
    assert set(spreads(hall, f"position=0.1,objects={objects}")) == names


def test_of_two_for_one_object_the_later_counts(hall: ResolvedScenario) -> None:
    by_name = spreads(hall, "position=0.1,delay=1; position=0,heading=4deg,objects=scout; delay=5,objects=walker")
    assert by_name["scout"].heading == pytest.approx(math.radians(4))
    assert (by_name["scout"].position, by_name["scout"].delay) == (0.0, 1.0)
    assert (by_name["walker"].position, by_name["walker"].delay) == (0.1, 5.0)


def test_the_scenario_itself_stays_as_it_is(hall: ResolvedScenario) -> None:
    assert perturbed(hall, ()) is hall
    assert random_parts(hall) == ["placement"]
    changed = perturbed(hall, read_perturbations("position=0.1,speed=0.1"))
    assert random_parts(changed) == ["placement", "start positions", "speeds"]
    assert [record.spreads for record in hall.objects] == [None] * len(hall.objects)
    assert perturbed_message(hall) == []
    assert random_parts(perturbed(hall, read_perturbations("position=0"))) == ["placement"]


def test_what_is_perturbed_is_said_by_groups(hall: ResolvedScenario) -> None:
    given = "position=0.1,heading=0.2,objects=robot; speed=10%,delay=2,objects=walker"
    assert perturbed_message(perturbed(hall, read_perturbations(given))) == [
        "start ±0.1 m in x and in y, heading ±0.2 rad of 'scout', 'car'",
        "speeds ±10 %, start delayed by 0 to 2 s of 'walker'",
    ]


@pytest.mark.parametrize(
    ("given", "message", "fix"),
    [
        ("position=1,objects=scot", "no object of 'hall' has the name, tag or role 'scot'", "did you mean scout?"),
        ("position=1,objects=boundary", "has the name, tag or role 'boundary'", "give one of scout, car"),
        ("delay=1,objects=post", "there is nothing to perturb in 'hall'", "choose other"),
        ("position=1,objects=robot_2", "there is nothing to perturb in 'hall'", "choose other"),
    ],
)
def test_what_does_not_fit_the_scenario_is_refused(hall: ResolvedScenario, given: str, message: str, fix: str) -> None:
    with pytest.raises(InputError) as error:
        spreads(hall, given)
    assert message in error.value.message
    assert fix in str(error.value.fix)


def test_its_schema_has_units_and_descriptions() -> None:
    schema = Perturbation.model_json_schema()["properties"]
    assert set(schema) == {"position", "heading", "speed", "delay", "objects"}
    assert all(item["description"] for item in schema.values())
    assert '"x-unit": "m"' in str(schema["position"]).replace("'", '"')
    assert "string" in str(schema["heading"])


RANDOM = ["{name: avocado}", "{name: footprint_orca}", "{name: follow, local: avocado}"]
CERTAIN = ["{name: avocado, noise: 0}", "{name: orca}", "{name: follow, local: orca}"]


@pytest.mark.parametrize(("behavior", "random"), [(b, True) for b in RANDOM] + [(b, False) for b in CERTAIN])
def test_behaviors_that_draw_random_numbers_make_a_run_random(behavior: str, random: bool) -> None:
    text = f"robot:\n  - {{kinematics: {{name: diff}}, goal: [5, 5, 0], behavior: {behavior}}}\n"
    assert random_parts(or_raise(read(text, strict=True))[0]) == (["decisions"] if random else [])
