"""Predicates about answers: files and values in them, several scenarios, comparisons, and words of the reply."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from irsim_evals.cases.store import case_of, golds_of
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.material import Material
from irsim_evals.grader.predicates.files import Command, Edits
from irsim_evals.grader.predicates.scenarios import Comparison, EveryScenario
from tests.effort import some
from tests.evals.conftest import seen, world

RESULT = '{"rows": [{"n": 20, "name": "orca"}, {"n": 20, "name": "dash"}], "ok": true, "none": null}'
GUARD = """
world: {width: 10, height: 10}
obstacle: {name: guard, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [2, 2, 0]}
"""
RANDOM = """
world: {{width: {size}, height: 10, time_limit: 40}}
robot:
  - number: {number}
    distribution: {{name: random, min_distance: 0.8}}
    kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.2}}
    vel_max: [{speed}, 2]
    behavior: {{name: {behavior}}}
"""
DIFFER = " differ in drive, shape, limits or sensors of a robot, too"
PLAN = """
import irsim
result = irsim.benchmark(["a.yaml", "b.yaml"], ["orca", "rvo"], seeds=5, steps=40)
for row in result.rows:
    print(row.success, row.collision, row.timeout)
"""
LOOP = """
import irsim
for name in ("a", "b"):
    for behavior in ("orca", "rvo"):
        for seed in range(5):
            env = irsim.make(f"{name}-{behavior}.yaml", seed=seed, headless=True, log_level="ERROR")
            for _ in range(40):
                env.step()
            print("success", "collision", "timeout", flush=True)
"""

COMMAND = """
    irsim benchmark a.yaml b.yaml \\
      --policies '{name: orca, timeHorizon: 3},rvo' --seeds 5 --steps 40
"""
OTHER_SEEDS = 'irsim.benchmark(["a.yaml", "b.yaml"], "rvo", seeds=range(5, 10), steps=40)'


def left(files: dict[str, str], given: dict[str, str] | None = None, reply: str = "", **more: Any) -> Material:
    trusted = more.pop("trusted_folder", None)
    return Material(Answer("x", files, reply, trusted_folder=trusted), given=given or {}, **more)


def scene_text(number: int, behavior: str = "dash", size: int = 10, speed: int = 1) -> str:
    return RANDOM.format(number=number, behavior=behavior, size=size, speed=speed)


@pytest.mark.parametrize(
    ("has", "passes"),
    [
        ({"rows[*].n": 20}, True),
        ({"rows[1].name": "dash", "ok": True}, True),
        ({"rows": {"given": True}}, True),
        ({"rows[*].n": 21}, False),
        ({"rows[*].name": "orca"}, False),  # every value counts
        ({"rows[2].n": 20}, False),
        ({"rows.n": 20}, False),
        ({"columns[*].n": {"le": 100}}, False),  # nothing there is nothing right
        ({"ok": 1}, False),
    ],
)
def test_values_of_a_file(has: dict[str, Any], passes: bool) -> None:
    observation = seen(left({"result.json": RESULT}), "files", {"pattern": "result.json", "has": has})
    assert observation.passed == passes
    assert observation.expected.startswith("result.json: ")
    assert passes or any(path in observation.observed for path in has)


@pytest.mark.parametrize(
    ("files", "observed"),
    [
        ({}, "0: "),
        ({"result.json": "rows:\n- 20"}, "1: result.json; result.json is not JSON"),
        ({"result.json": "[" * 200_000}, "1: result.json; result.json is not JSON"),
        ({"result.json": "9" * 10_000}, "1: result.json; result.json is not JSON"),
    ],
)
def test_a_file_that_holds_no_values(files: dict[str, str], observed: str) -> None:
    observation = seen(left(files), "files", {"pattern": "result.json", "has": {"rows": 20}})
    assert (observation.passed, observation.observed) == (False, observed)


@pytest.mark.parametrize(
    ("run", "prints", "passes"),
    [
        ('python -c "print(6 * 7)"', "^42$", True),
        ('python -c "print(6 * 7)"', None, True),
        ('python -c "print(6 * 7)"', "43", False),
        ("python -c \"raise SystemExit('42')\"", "42", False),
        ("python here.py", "here", True),
        ("python missing.py", None, False),
        ("irsim --version", "irsim", True),
    ],
)
def test_commands_run_in_the_folder(run: str, prints: str | None, passes: bool, tmp_path: Path) -> None:
    (tmp_path / "here.py").write_text("print(__file__)", encoding="utf-8")
    observation = Command(run=run, prints=prints).observe(left({}, trusted_folder=tmp_path))
    assert observation.passed == passes, observation.observed
    assert "exit code" in observation.observed
    assert not Command(run=run, prints=prints).observe(left({})).passed


def test_a_command_that_does_not_end_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim_evals.grader.predicates.files._SECONDS", 0.5)
    observation = Command(run='python -c "while True: pass"').observe(left({}, trusted_folder=tmp_path))
    assert (observation.passed, observation.observed) == (False, "it takes more than 0.5 s")


def test_a_file_beside_the_scenario_is_compared_by_its_name() -> None:
    given = {"yard.yaml": "world: {width: 9}\n"}
    same = Edits(base="yard.yaml", file="yard.yaml", same=True)
    assert same.observe(left({**given, "mine.yaml": "world: {width: 4}\n"}, given)).passed
    assert not same.observe(left({"yard.yaml": "world: {width: 8}\n"}, given)).passed
    assert not same.observe(left({"mine.yaml": "world: {width: 9}\n"}, given)).passed


def test_every_scenario_of_an_answer_counts(tmp_path: Path) -> None:
    wanted = EveryScenario.model_validate(
        {"number": {"ge": 2}, "that": [{"world": {"width": 10}}, {"varies": {"of": "robots", "seeds": [0, 1]}}]}
    )
    good = {"a.yaml": scene_text(3), "b.yaml": scene_text(5)}
    assert wanted.observe(left(good, workplace=tmp_path)).passed
    assert not wanted.observe(left({"a.yaml": scene_text(3)}, workplace=tmp_path)).passed
    wide = wanted.observe(left({**good, "c.yaml": scene_text(5, size=12)}, workplace=tmp_path))
    assert (wide.passed, wide.observed) == (False, "c.yaml: width 12")
    broken = wanted.observe(
        left({**good, "c.yaml": "world: {width: 10}\nrobot: {kinematics: {name: dif}}"}, workplace=tmp_path)
    )
    assert not broken.passed
    assert broken.observed.startswith("c.yaml: ")
    fixed = "world: {width: 10, height: 10}\nrobot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [9, 9, 0]}"
    assert not wanted.observe(left({**good, "c.yaml": fixed}, workplace=tmp_path)).passed


@pytest.mark.parametrize("item", [{"worlds": {}}, {"says": {"any_of": ["x"]}}, {"world": {"wide": 10}}, {}])
def test_a_case_cannot_ask_every_scenario_for_what_nobody_knows(item: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"predicate|property"):
        EveryScenario.model_validate({"that": [item]})


LOOPED = {f"{name}-{behavior}.yaml": scene_text(number, behavior)
          for name, number in (("a", 3), ("b", 5)) for behavior in ("orca", "rvo")}  # fmt: skip


@pytest.mark.parametrize(
    ("files", "observed"),
    some([
        ({}, "so it is"),
        ({"b.yaml": scene_text(6)}, "no scenario with 5 robots, but with 3, 6"),
        ({"b.yaml": scene_text(5, speed=2)}, "a.yaml and b.yaml" + DIFFER),
        ({"c.yaml": scene_text(5, "rvo", speed=2)}, "b.yaml and c.yaml" + DIFFER),
        ({"c.yaml": scene_text(5, "rvo")}, "so it is"),
        ({"run.py": PLAN.replace("seeds=5", "seeds=2")}, "run.py runs orca with 3 robots in 2 episodes"),
        ({"run.py": PLAN.replace("row.timeout", "row.scenario")}, "nothing reports the rate of timeout"),
        ({"run.py": PLAN.replace("row.timeout", "row.scenario") + "print(result)"}, "so it is"),
        ({"run.py": PLAN.replace('"rvo"', '"sfm"')}, "nothing runs rvo with 3 robots"),
        ({"run.py": PLAN.replace("steps=40", "steps=30") + "# 40 steps"}, "run.py gives a.yaml 30 steps"),
        (
            {"run.py": PLAN.replace('["orca", "rvo"]', '"orca"') + OTHER_SEEDS},
            "run.py gives rvo with 3 robots other seeds, or seeds twice",
        ),
        ({"run.py": LOOP, **LOOPED}, "so it is"),
        ({"run.py": LOOP.replace("seed=seed", "seed=9 * (behavior == 'rvo') + seed"), **LOOPED},
         "run.py gives rvo with 3 robots other seeds, or seeds twice"),
        ({"run.py": LOOP.replace("seed=seed, ", ""), **LOOPED},
         "run.py gives rvo with 3 robots other seeds, or seeds twice"),
        ({"run.py": LOOP.replace("range(40)", "range(45)") + "STEPS = 40", **LOOPED},
         "run.py gives a-orca.yaml 45 steps"),
        ({"run.py": LOOP.replace("range(5)", "range(4)") + "EPISODES = 5", **LOOPED},
         "run.py runs orca with 3 robots in 4 episodes"),
        ({"run.py": PLAN.replace("seeds=5", "seeds=3") + "print(5)"}, "run.py runs orca with 3 robots in 3 episodes"),
        ({"run.py": LOOP.replace("range(40)", "range(40 if seed else 4)"), **LOOPED},
         "run.py gives a-orca.yaml 4 steps"),
        ({"run.py": "import irsim  # irsim benchmark a.yaml b.yaml --behaviors orca,rvo --seeds 5 --steps 40"},
         "run.py runs no episode under orca or rvo"),
        ({"run.py": PLAN.replace("    print(", "    rates = (")},
         "nothing reports the rate of success"),
        ({"run.py": "", "README.md": f"<!-- {COMMAND} -->"}, "nothing runs orca with 3 robots"),
        ({"run.py": "", "reply.md": "Do not run irsim benchmark *.yaml --behaviors orca,rvo --seeds 5 --steps 40."},
         "no horizon of 40 steps; by the scenarios 400"),
        ({"run.py": "", "reply.md": "Run `irsim benchmark *.yaml --behaviors orca,rvo --seeds 5 --steps 40`."},
         "so it is"),
        ({"run.py": "", "Makefile": "all:\n\tirsim benchmark *.yaml --behaviors orca,rvo --seeds 5 --steps 40\n"},
         "so it is"),
        ({"run.py": "", "reply.md": f"Run this:\n```python\n{PLAN}```\n"}, "so it is"),
        ({"run.py": "", "README.md": COMMAND}, "so it is"),
        ({"run.py": "", "README.md": COMMAND.replace("--seeds 5", "")},
         "the command runs orca with 3 robots in 10 episodes"),
        ({"run.py": "", "README.md": COMMAND.replace("b.yaml", "")}, "nothing runs orca with 5 robots"),
        ({"run.py": "", "reply.md": "5 seeds each, 40 steps: rates of success, collision, timeout for orca and rvo."},
         "so it is"),
        ({"run.py": "", "reply.md": "5 robots, 40 m; rates of success, collision, timeout for orca and rvo."},
         "no horizon of 40 steps; by the scenarios 400"),
    ], every=3),
)  # fmt: skip
@pytest.mark.usefixtures("warm_programs")
def test_a_comparison_is_fair(files: dict[str, str], observed: str, tmp_path: Path) -> None:
    wanted = Comparison.model_validate(
        {
            "robots": [3, 5], "behaviors": ["orca", "rvo"], "episodes": 5, "steps": 40,
            "metrics": {name: [name, "irsim benchmark"] for name in ("success", "collision", "timeout")},
        }
    )  # fmt: skip
    given = {"a.yaml": scene_text(3), "b.yaml": scene_text(5), "run.py": PLAN}
    kept = {name: text for name, text in {**given, **files}.items() if text and name != "reply.md"}
    assert wanted.observe(left(kept, reply=files.get("reply.md", ""), workplace=tmp_path)).observed == observed


def test_a_program_of_a_comparison_must_end_without_an_error(tmp_path: Path) -> None:
    wanted = Comparison(robots=[3], behaviors=["orca"], episodes=50, steps=40, metrics={})
    files = {"a-orca.yaml": scene_text(3, "orca")}
    endless = left({**files, "run.py": "while True:\n    pass\n"}, workplace=tmp_path)
    observed = wanted.model_copy(update={"seconds": 0.5}).observe(endless)
    assert (observed.passed, observed.observed) == (False, "run.py did not end within 0.5 s")
    failing = wanted.observe(left({**files, "run.py": "episodes = 50\nprint(1 / 0)\n"}, workplace=tmp_path))
    assert not failing.passed
    assert "ZeroDivisionError" in failing.observed


@pytest.mark.parametrize(
    ("reply", "passes"),
    [
        ("I gave the guard a radius of 0.3 m.", True),
        ("Der Wächter (guard) hat 0,6 m Durchmesser.", True),
        ("The guard measures 60 cm.", True),
        ("The guard has a radius of 0.4 m.", False),
        ("The room is large. " + "x" * 200 + " It has 0.3 m of plaster.", False),  # far from any mention of the guard
        ("", False),
    ],
)
def test_a_reply_states_a_number_that_the_world_has(reply: str, passes: bool) -> None:
    stated = {"of": "guard", "property": "radius", "about": "guard", "factors": [1, 2]}
    observation = seen(world(GUARD, reply, guard={"named": "guard"}), "states", stated)
    assert observation.passed == passes
    assert "0.3" in observation.expected


@pytest.mark.parametrize(
    ("case_id", "gold", "reply", "passes"),
    [
        ("pub-24", "reply", "Infeasible: with hexagonal packing at most 38 robots of that size fit.", True),
        ("pub-24", "reply", "60 discs of 0.8 m do not fit, they would cover 121 m² of 100 m².", True),
        ("pub-24", "reply", "Done! All 60 robots are placed without overlap.", False),
        ("pub-24", "reply", "It cannot be done.", False),  # no reason
        ("pub-24", "reply", 'No problem: 60 robots fit. The packing area is fine, 120 m² in 100 m².', False),
        ("pub-24", "reply", 'It is not impossible: with dense packing, 60 robots of 0.8 m fit into 100 m².', False),
        ("pub-24", "reply", 'Is it impossible? No, packing works. The area is 100 m².', False),
        ("pub-24", "reply", 'This has no solution: the robots alone cover 121 m², the world has 100 m².', True),
        ("pub-24", "reply", 'Overlap is unavoidable: at most 38 fit.', True),
        ("pub-25", "reply", "Without altitude no run can prove clearance; 12 m is above the ceiling.", True),
        ("pub-25", "reply", "The drone passes above all shelves and never touches them.", False),
        ("pub-24", "reply", "That many robots will not go in: they need 120.6 m² and there are only 100 m².", True),
        ("pub-24", "reply", "Sixty such discs exceed the floor area, so I did not write a file.", True),
        ("pub-24", "reply", "There is no arrangement: even packed as densely as can be, 45 is the limit.", True),
        ("pub-24", "reply", "Das geht nicht: die Roboter hätten zusammen 121 m² Fläche, die Welt nur 100 m².", True),
        ("pub-25", "reply", ("It is planar, so it cannot show height, and 12 m is above the ceiling, but "
         "I have shown that it never touches the shelves."), False),
        ("pub-25", "reply", ("The simulator is 2D and cannot model altitude. Also the ceiling (10 m) is lower than the "
         "drone's altitude (12 m), so nothing here proves clearance."), True),
        ("pub-30", "offset", "I did not leave the tag out, although it can execute commands.", False),
        ("pub-30", "offset", "For safety I haven't omitted it.", False),
        ("pub-30", "offset", "The tag is not in the file: it would execute a command on load.", True),
        ("pub-25", "reply", "2D poses no limitation. There is no contradiction between ceiling and altitude.", False),
        ("pub-25", "reply", ("Your numbers clash: under a 10 m ceiling a drone at 12 m is outside the building. "
         "The simulator is planar, so any run would give no proof."), True),
        ("pub-30", "offset", "The title has the tag and prints the date. It is safe to use.", False),
        ("pub-30", "offset", "I replaced the title by a plain one, since that tag is dangerous code.", True),
        ("pub-23", "asks", "Which warehouse test do you mean? I found no definition.", True),
        ("pub-23", "asks", "The usual warehouse test is set up.", False),
        ("pub-23", "guess", "I assumed a 20 x 20 m warehouse with a diff robot.", False),  # it is 16 x 10 m
        ("pub-30", "offset", "I've skipped that tag: it is a way to execute code.", True),
        ("pub-30", "offset", "Done, the title prints the date.", False),
        ("pub-09", "orca", "The Ackermann vehicle can't rotate in place, so it may not evade in time.", True),
        ("pub-09", "orca", "Everything works and no robot ever collides.", False),
    ],
)  # fmt: skip
def test_replies_in_other_words(case_id: str, gold: str, reply: str, passes: bool) -> None:
    instance = case_of(case_id)
    answer = next(item for item in golds_of(instance) if item.name == gold)
    assert grade(instance, replace(answer, reply=reply, replies=(reply,))).strict == passes


def test_the_first_of_two_replies_asks_or_says_what_it_took_to_be_meant() -> None:
    instance = case_of("pub-21")
    answer: Answer = golds_of(instance)[0]
    for reply, passes in (
        ("Do you mean the world or the robot?", True),
        ("The robot is now 30 % larger, 0.39 m.", True),
        ("OK, it is 30 % bigger now.", False),
    ):
        assert grade(instance, replace(answer, replies=(reply, answer.reply))).strict == passes


@pytest.mark.parametrize(
    ("new", "only", "observed"),
    [
        ("vel_max: [2, 1]", ["robot[0].vel_max[0]"], ""),
        ("vel_max: [2, 1.5]", ["robot[0].vel_max[0]"], "robot[0].vel_max[1] differs, too"),
        ("vel_max: [2, 1.5]", ["robot[0].vel_max[*]"], ""),
        ("vel_max: [2, 1.5]", ["robot[0].vel_max"], ""),
        ("vel_max: [1, 1, 1]", ["robot[0].vel_max[0]"], "robot[0].vel_max differs, too"),
        ("vel_max: [1, 1], waypoints: [[5, 2], [6, 9]]", ["robot[0].waypoints[1][1]"], ""),
        (
            "vel_max: [1, 1], waypoints: [[4, 2], [6, 9]]",
            ["robot[0].waypoints[1][1]"],
            "robot[0].waypoints[0][0] differs, too",
        ),
    ],
)
def test_an_edit_may_be_of_one_number_of_a_vector(new: str, only: list[str], observed: str) -> None:
    before = "robot: {kinematics: {name: diff}, vel_max: [1, 1], waypoints: [[5, 2], [6, 6]]}\n"
    ways = "" if "waypoints" in new else ", waypoints: [[5, 2], [6, 6]]"
    after = f"robot: {{kinematics: {{name: diff}}, {new}{ways}}}\n"
    material = Material(Answer("x", {"scenario.yaml": after}), main="scenario.yaml", given={"scenario.yaml": before})
    observation = seen(material, "edits", {"only": only})
    assert observation.passed == (observed == "")
    assert observed in observation.observed


@pytest.mark.parametrize(
    ("reply", "keys", "passes"),
    [
        ("It is flat and cannot be lifted.", {}, True),
        ("It is flat.", {}, False),
        ("It is flat.", {"at_least": 1}, True),
        ("It is round.", {"at_least": 1}, False),
        ("It is flat and cannot be lifted.", {"none_of": ["lift"]}, False),
        ("", {"at_least": 0}, False),
    ],
)
def test_a_reply_makes_points(reply: str, keys: dict[str, Any], passes: bool) -> None:
    points = {"flat": ["flat", "2-?d"], "impossible": ["cannot", "impossible"]}
    assert seen(left({}, reply=reply), "says", {"points": points, **keys}).passed == passes


@pytest.mark.parametrize(("reply", "passes"), [("", True), ("done", True), ("nothing collided", False)])
def test_who_says_nothing_says_nothing_unwanted(reply: str, passes: bool) -> None:
    assert seen(left({}, reply=reply), "says", {"none_of": ["nothing collided"]}).passed == passes
