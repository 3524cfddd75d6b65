"""Suites: what a file may say, what it expands to, what its protocols do, and how its mistakes are named."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from PIL import Image
from typer.testing import CliRunner

import irsim
from irsim.benchmarks.stored import resume_benchmark, run_plan
from irsim.benchmarks.suite import SUITES, Suite, SuiteError, is_suite, load_suite
from irsim.benchmarks.suite_plan import suite_plan, suite_policy, suite_scene
from irsim.cli.app import app
from irsim.env import Env
from irsim.lookup import lookup
from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text

MINIMAL: dict[str, Any] = {
    "suite": "mine", "version": 1, "title": "Mine", "steps": 50, "policies": {"dash": "dash"},
    "scenarios": [{"name": "one", "template": "crossing"}],
}  # fmt: skip


def written(tmp_path: Path, **changes: Any) -> Path:
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({**MINIMAL, **changes}), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", SUITES.names())
def test_bundled_suites_are_valid_and_their_scenarios_can_be_built(name: str) -> None:
    suite, _ = load_suite(name)
    assert suite.suite == name
    for scenario in suite_plan(name).scenarios:
        reading = read(scenario.document())
        assert [item.message for item in reading.diagnostics if item.severity == "error"] == []


WORLD: dict[str, Any] = {"name": "one", "scenario": {"world": {}}}


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"steps": 0}, "steps"),
        ({"polices": {}}, "'polices' is not a key of a suite"),
        ({"title": None}, "title"),
        ({"scenarios": []}, "scenarios"),
        ({"scenarios": [{"name": "one"}]}, "give exactly one of template, scenario and file, not none"),
        ({"scenarios": [{"name": "one", "template": "crossing", "file": "x.yaml"}]}, "not template and file"),
        ({"scenarios": MINIMAL["scenarios"] * 2}, "two scenarios have the name 'one'"),
        ({"protocols": ["freeze", "freeze"]}, "listed twice"),
        ({"protocols": ["melt"]}, "protocols"),
        ({"seeds": {"count": 5, "full": 3}}, "full must be at least count (5), got 3"),
        ({"density": "robot[0].number"}, "which no scenario varies"),
        ({"scenarios": [{"name": "a b", "template": "crossing"}]}, "scenarios[0].name"),
        ({"scenarios": [{"name": "one", "template": "crosing"}]}, "there is no template 'crosing'"),
        ({"scenarios": [{"name": "one", "template": "crossing", "parameters": {"spede": 1}}]}, "spede"),
        ({"scenarios": [{"name": "one", "file": "nowhere.yaml"}]}, "nowhere.yaml is not a scenario file"),
        ({"scenarios": [{**WORLD, "vary": {"robot[0].number": [1]}}]}, "has nothing at 'robot[0].number'"),
        ({"scenarios": [{**WORLD, "vary": {"world.width": list(range(1, 300))}}]}, "more than 200"),
        ({"scenarios": [{**WORLD, "vary": {"world.name": ["a b", "a/b"]}}]}, "are called 'one-a-b'"),
    ],
)
def test_every_problem_of_a_suite_file_is_named(changes: dict[str, Any], problem: str, tmp_path: Path) -> None:
    with pytest.raises(SuiteError) as caught:
        suite_plan(str(written(tmp_path, **changes)))
    assert problem in caught.value.message


def test_several_problems_are_named_at_once(tmp_path: Path) -> None:
    with pytest.raises(SuiteError) as caught:
        suite_plan(str(written(tmp_path, steps=0, version="x", protocols=[])))
    assert all(key in caught.value.message for key in ("steps", "version", "protocols"))


def test_every_combination_of_values_is_a_scenario_under_every_protocol(tmp_path: Path) -> None:
    robot = {"number": 1, "distribution": {"name": "random"}}
    field = {"world": {"width": 5, "step_time": 0.2}, "robot": [robot]}
    vary = {"robot[0].number": [1, 2], "world.height": [5, 7.5]}
    scenario = {"name": "field", "scenario": field, "vary": vary}
    plan = suite_plan(str(written(tmp_path, scenarios=[scenario], protocols=["yield", "freeze"])))
    names = [f"field-{n}-{h}" for n in (1, 2) for h in ("5", "7.5")]
    assert [one.name for one in plan.scenarios] == [f"{n}/{p}" for p in ("yield", "freeze") for n in names]
    last = yaml.safe_load(plan.scenarios[-1].text)
    ends = {"after_arrival": "freeze", "time_limit": 10.0}
    assert last["world"] == {"width": 5, "height": 7.5, "step_time": 0.2, **ends}
    assert last["robot"][0]["number"] == 2
    kept = suite_plan(str(written(tmp_path, scenarios=[scenario])), scenarios=["field-2-5"], policies=["dash", "rvo"])
    assert [one.name for one in kept.scenarios] == ["field-2-5"]
    assert kept.policies == {"dash": "dash", "rvo": "rvo"}


def test_a_scenario_file_may_name_a_map_beside_it(tmp_path: Path) -> None:
    Image.new("L", (20, 20), 255).save(tmp_path / "hall.png")
    scene = "world: {width: 5, height: 5, obstacle_map: hall.png}\nrobot: {goal: [4, 4, 0]}\n"
    (tmp_path / "hall.yaml").write_text(scene)
    file = written(tmp_path, scenarios=[{"name": "hall", "file": "hall.yaml"}])
    [one] = suite_plan(str(file)).scenarios
    assert (one.folder, list(one.maps)) == (str(tmp_path), ["hall.png"])
    before = suite_plan(str(file)).hash
    Image.new("L", (20, 20), 0).save(tmp_path / "hall.png")
    assert suite_plan(str(file)).hash != before


def test_a_file_is_a_suite_if_it_says_so(tmp_path: Path) -> None:
    assert is_suite("random_polygons_v1")
    assert is_suite(str(written(tmp_path)))
    (tmp_path / "scene.yaml").write_text("world: {width: 5}\n")
    assert not is_suite(str(tmp_path / "scene.yaml"))
    assert not is_suite("nowhere.yaml")


MEETING = """
world: {{width: 10, height: 10, after_arrival: {mode}}}
robot:
  - number: 2
    distribution: {{name: manual}}
    kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.3}}
    state: [[2, 5, 0], [0.5, 5, 0]]
    goal: [[5, 5], [9, 5.02]]
    behavior: {{name: orca}}
"""


@pytest.mark.parametrize(
    ("mode", "stands", "latched"), [("freeze", True, True), ("yield", False, True), ("null", False, False)]
)
def test_what_a_robot_does_that_has_arrived(mode: str, stands: bool, latched: bool) -> None:
    scenario = read(load_text(MEETING.format(mode=mode))).scenario
    assert scenario is not None
    env = Env(scenario, seed=1, display=False, headless=True, log_level="ERROR")
    first = env.robot_list[0]
    place, moved, lost = None, 0.0, 0
    while not env.done() and env.time < 20:
        env.step()
        if first.arrive and place is None:
            place = first.state[:2, 0].copy()
        if place is not None:
            moved = max(moved, float(abs(first.state[:2, 0] - place).max()))
            lost += not first.arrive
    assert (moved == 0, lost == 0) == (stands, latched)
    assert all(robot.arrive for robot in env.robot_list)


DASHES = """
world: {width: 20, height: 10, collision_mode: stop, after_arrival: yield}
robot:
  - number: 2
    distribution: {name: manual}
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.3}
    state: [[1, 2, 0], [1, 8, 0]]
    goal: GOALS
    behavior: {name: dash}
obstacle:
  - kinematics: {name: omni}
    shape: {name: circle, radius: 0.3}
    state: [9, 2, 0]
    goal: [1, 2, 0]
    behavior: {name: dash}
"""


@pytest.mark.parametrize(("goal", "step"), [([9, 2], 38), ([2, 2], 66)], ids=["under way", "after arrival"])
def test_the_first_collision_of_an_episode_decides_it(goal: list[int], step: int) -> None:
    result = irsim.benchmark(DASHES.replace("GOALS", str([goal, [19, 8]])), until="first_collision", steps=400)
    [episode] = result.episodes
    assert (episode.outcome, episode.steps) == ("collision", step)
    assert episode.failures == {"robot_0": "collision with 'obstacle_2'"}
    assert [episode.metrics[key] for key in ("success", "collision", "timeout")] == [0, 1, 0]
    assert not any("ended early" in note for note in result.notes)


def test_a_scenario_is_named_with_or_without_its_protocol(tmp_path: Path) -> None:
    suite = str(written(tmp_path, protocols=["freeze", "yield"]))
    for name, count in (("one", 2), ("one/yield", 1)):
        assert len(suite_plan(suite, scenarios=[name]).scenarios) == count


def test_seeds_of_a_suite_are_a_number_of_its_own_or_others(tmp_path: Path) -> None:
    suite = str(written(tmp_path, seeds={"first": 7, "count": 4, "full": 6}))
    plan = suite_plan(suite)
    assert (plan.seeds, suite_plan(suite, full=True).seeds) == ([7, 8, 9, 10], [7, 8, 9, 10, 11, 12])
    few, others, one = (suite_plan(suite, seeds=seeds) for seeds in (2, [3, 4, 5], [9]))
    assert (few.seeds, others.seeds) == ([7, 8], [3, 4, 5])
    assert [p.reproduce.partition("--seeds ")[2] for p in (few, others, one)] == ["2", "3-5", "9,"]
    assert len({p.suite_hash for p in (plan, few, others)}) == 1
    assert len({p.hash for p in (plan, few, others)}) == 3
    with pytest.raises(SuiteError, match="100,004 are more seeds than random_polygons_v2 is made for") as refused:
        suite_plan("random_polygons_v2", seeds=100_004)
    assert "seed 100004 alone is '100004-100004'" in str(refused.value)
    with pytest.raises(SuiteError, match="at least one seed"):
        suite_plan(suite, seeds=0)
    with pytest.raises(SuiteError, match="contradict"):
        suite_plan(suite, seeds=3, full=True)


def test_a_scenario_of_a_suite_is_run_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, protocols=["freeze", "yield"])
    result = irsim.run("mine.yaml/one/yield", seed=3, policy="dash")
    assert result.reproduce == "irsim run mine.yaml/one/yield --seed 3 --policy dash"
    assert result.time_limit == 5.0
    [episode] = irsim.benchmark({"one": suite_scene("mine.yaml/one/yield").document()}, ["dash"], [3]).episodes
    assert (episode.outcome, episode.steps) == (result.outcome, result.steps)
    for name, fix in (("mine.yaml", "mine.yaml/one/freeze"), ("mine.yaml/on", "did you mean mine.yaml/one")):
        with pytest.raises(SuiteError) as refused:
            irsim.run(name)
        assert fix in str(refused.value)


def test_a_folder_that_a_plan_names_can_be_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Image.new("L", (20, 20), 255).save(tmp_path / "map.png")
    robot = {"kinematics": {"name": "diff"}}
    scenario = {"world": {"width": 4, "height": 4, "obstacle_map": "map.png"}, "robot": [robot]}
    written(tmp_path, scenarios=[{"name": "one", "scenario": scenario}], steps=3)
    monkeypatch.chdir(tmp_path)
    run_plan(suite_plan("mine.yaml"), Path("out"))
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert resume_benchmark(Path("../out")).episodes


def test_policies_of_a_suite_have_their_options_when_one_scenario_is_run() -> None:
    result = irsim.run("random_polygons_v1/robots-5/freeze", seed=142, policy="orca")
    options = suite_plan("random_polygons_v1").policies["orca"]
    assert (result.outcome, result.behavior) == ("collision", options)


def test_other_policies_run_only_where_they_are_named_and_do_not_change_the_suite() -> None:
    suite = load_suite("random_polygons_v1")[0]
    with_them, without = (suite_plan(one) for one in (suite, suite.model_copy(update={"others": {}})))
    assert (with_them.hash, with_them.suite_hash) == (without.hash, without.suite_hash)
    assert "ppo" not in with_them.policies
    named = suite_plan("random_polygons_v1", policies=["orca", "ppo"])
    assert named.policies["ppo"] == "multi_robot"
    assert named.hash != without.hash
    assert suite_policy("random_polygons_v1/robots-5/yield", "ppo") == "multi_robot"
    with pytest.raises(ValueError, match="policies and others both have 'orca'"):
        Suite.model_validate({**suite.model_dump(), "others": {"orca": "orca"}})


# mistakes, with their places and what was probably meant ------------------------------------------------------------
FIELD = """\
suite: field
version: 1
title: Robots among posts
steps: 400
scenarios:
  - name: field
    vary: {"robot[0].number": [2, 4]}
    scenario:
      world: {width: 10, height: 10}
      robot: [{kinematics: {name: diff}, distribution: {name: random}}]
policies: {dash: dash}
"""


def problem_of(tmp_path: Path, text: str) -> SuiteError:
    """The error of a suite with this text."""
    (tmp_path / "field.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SuiteError) as caught:
        suite_plan(str(tmp_path / "field.yaml"))
    return caught.value


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("].number", "].nummer", "line 7: scenario 'field' has no key robot[0].nummer, did you mean number?"),
        ("width:", "widht:", "line 9: scenario 'field': world.widht: "),
        ("number\": [2, 4]", "kinematics.name\": [diff, dif]", "line 7: scenario 'field': robot[0].kinematics.name: "),
        ("version: 1", "steps: 500\nversion: 1", "line 5: steps: the key 'steps' is given a second time"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_scenario_is_named_with_its_line(old: str, new: str, problem: str, tmp_path: Path) -> None:
    error = problem_of(tmp_path, FIELD.replace(old, new))
    assert problem in error.message
    assert error.diagnostics[0].line is not None


@pytest.mark.parametrize(
    ("scene", "problem"),
    [
        ("world: {width: 5}\nrobot:\n  - {nummer: 3}\n", "line 3: scenario 'field': robot[0].nummer: "),
        ("world: {width: 5}\nworld: {width: 6}\n", "line 2: world: the key 'world' is given a second time"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_scenario_file_is_named_with_that_file(scene: str, problem: str, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(scene, encoding="utf-8")
    start, end = FIELD.index("    vary"), FIELD.index("policies")
    error = problem_of(tmp_path, f"{FIELD[:start]}    file: scene.yaml\n{FIELD[end:]}")
    assert f"{tmp_path / 'scene.yaml'}, {problem}" in error.message


def test_values_of_a_list_of_mappings_change_together(tmp_path: Path) -> None:
    file = tmp_path / "field.yaml"
    old = '{"robot[0].number": [2, 4]}'
    pairs = '[{"robot[0].number": 1, world.height: 20}, {"robot[0].number": 2, world.height: 40}]'
    file.write_text(FIELD.replace(old, pairs) + "density: robot[0].number\n", encoding="utf-8")
    plan = suite_plan(str(file))
    assert [one.name for one in plan.scenarios] == ["field-1-20", "field-2-40"]
    assert [one.document().data["world"]["height"] for one in plan.scenarios] == [20, 40]
    error = problem_of(tmp_path, FIELD.replace(old, pairs.replace("t: 40", 't: 40, "robot[0].nummer": 3')))
    assert "line 7: scenario 'field' has no key robot[0].nummer, did you mean number?" in error.message


def test_validate_checks_a_suite_as_a_suite(tmp_path: Path) -> None:
    file = tmp_path / "field.yaml"
    file.write_text(FIELD, encoding="utf-8")
    assert [one.name for one in suite_plan(str(file)).scenarios] == ["field-2", "field-4"]
    good = CliRunner().invoke(app, ["validate", str(file)])
    assert (good.exit_code, "valid: suite field, 2 scenarios x 1 policies x 100 seeds" in good.output) == (0, True)
    file.write_text(FIELD.replace("].number", "].nummer").replace("steps: 400", "steps: 0"), encoding="utf-8")
    bad = CliRunner().invoke(app, ["validate", str(file), "--json"])
    [finding] = json.loads(bad.stdout)["findings"]
    assert (bad.exit_code, finding["path"], finding["line"]) == (2, "steps", 4)
    assert finding["message"] == "'steps' must be ≥ 1, got 0"


def test_a_misspelt_name_of_a_suite_is_named() -> None:
    done = CliRunner().invoke(app, ["benchmark", "circle_swop_v1"])
    assert (done.exit_code, "did you mean circle_swap_v1?" in done.output) == (2, True)


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("seeds: 5", "line 12: seeds: 5 is not a mapping (key: value)"),
        ("protocols: freeze", "line 12: protocols: 'freeze' is not a list"),
        ("protocols: [freese]", "choose from as-written, freeze, yield. Fix: protocols: freeze"),
        ("until: collision", "Fix: until: first_collision"),
        ("seeds: {cuont: 5}", "line 12: seeds.cuont: 'cuont' is not a key of 'seeds'. Fix: rename it to 'count'"),
        ("perturb: [{positoin: 1}]", "Fix: rename it to 'position'"),
        ("perturb: {position: 1}", "perturb: {position: 1} is not a list"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_explained_in_plain_words(line: str, problem: str, tmp_path: Path) -> None:
    message = str(problem_of(tmp_path, f"{FIELD}{line}\n"))
    assert problem in message
    assert "Input should" not in message
    assert "pattern" not in message


@pytest.mark.parametrize(
    ("topic", "text"),
    [
        ("seeds", "Number of episodes of each scenario"), ("density", "charts"), ("protocols", "yield"),
        ("until", "first_collision"), ("perturb", "Largest change of the start"), ("vary", "Or a list of mappings"),
        ("scenarios.file", "relative to the suite file"),
    ],
)  # fmt: skip
def test_every_key_of_a_suite_file_is_a_topic(topic: str, text: str) -> None:
    assert text in lookup(f"suites.{topic}").model_dump_json()


def test_a_scenario_in_which_nothing_can_be_perturbed_is_named(tmp_path: Path) -> None:
    Image.new("L", (20, 20), 255).save(tmp_path / "hall.png")
    text = FIELD.replace("height: 10}", "height: 10, obstacle_map: hall.png}")
    (tmp_path / "field.yaml").write_text(f"{text}perturb: [{{position: 0.1}}]\n", encoding="utf-8")
    arguments = ["benchmark", str(tmp_path / "field.yaml"), "--seeds", "1", "-o", str(tmp_path / "out")]
    done = CliRunner().invoke(app, arguments)
    assert (done.exit_code, "nothing to perturb in 'field-2'" in done.output) == (2, True)


def test_a_suite_may_be_like_another_one(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(
        "suite: mine\nlike: random_polygons_v2\nversion: 3\ntitle: Slower\nseeds: {first: 7, count: 2}\n"
        'overrides: {"robot[*].acce": [0.5, 2], "robot[*].goal_threshold": 0.5}\n'
    )
    base, (mine, _) = load_suite("random_polygons_v2")[0], load_suite(str(path))
    assert mine.scenarios == base.scenarios
    assert mine.policies == base.policies
    assert (mine.title, mine.version, mine.seeds.first, mine.seconds) == ("Slower", 3, 7, base.seconds)
    assert mine.overrides == {**base.overrides, "robot[*].acce": [0.5, 2], "robot[*].goal_threshold": 0.5}
    path.write_text(path.read_text().replace("random_polygons_v2", "random_polygon_v2"))
    with pytest.raises(SuiteError, match="did you mean random_polygons_v2"):
        load_suite(str(path))


@pytest.mark.parametrize("name", [name for name in SUITES.names() if name.endswith("_noisy")])
def test_a_noisy_twin_has_the_scenes_and_seeds_of_its_suite(name: str) -> None:
    noisy, ideal = suite_plan(name), suite_plan(name.removesuffix("_noisy"))
    assert [one.name for one in noisy.scenarios] == [one.name for one in ideal.scenarios]
    assert (noisy.seeds, noisy.policies) == (ideal.seeds, ideal.policies)
    assert noisy.suite_hash != ideal.suite_hash
