"""Predicates of the public cases, their replies in other words, and the facts that a mutant changes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.cases.model import Pin
from irsim_evals.cases.store import case_of, golds_of
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.material import Material
from irsim_evals.grader.predicates.passages import Pocket
from irsim_evals.grader.predicates.scenarios import Comparison, EveryScenario
from irsim_evals.grader.predicates.ways import Ways
from irsim_evals.grader.properties import value_of
from irsim_evals.proof.changes import changed_facts, touches
from tests.effort import some

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


def world(text: str) -> Material:
    return Material(scenario=read(load_text(text)).scenario, selectors={}, texts={"scenario.yaml": text})


def scene_text(number: int, behavior: str = "dash", size: int = 10, speed: int = 1) -> str:
    return RANDOM.format(number=number, behavior=behavior, size=size, speed=speed)


def left(tmp_path: Path, files: dict[str, str], reply: str = "") -> Material:
    return Material(scenario=None, selectors={}, texts=files, reply=reply, workplace=tmp_path)


@pytest.mark.parametrize(
    ("second", "passes"),
    [
        ("state: [9, 5.5, 0], goal: [1, 5.5, 0]", True),
        ("state: [9, 7, 0], goal: [1, 7, 0]", False),  # too far beside the first way
        ("state: [1, 5.5, 0], goal: [9, 5.5, 0]", False),  # the same direction
        ("state: [9, 5.5, 0]", False),  # no goal
    ],
)
def test_ways_of_two_robots_lead_past_each_other(second: str, passes: bool) -> None:
    material = world(
        "world: {width: 10, height: 10}\nrobot:\n"
        "  - {kinematics: {name: diff}, state: [1, 5, 0], goal: [9, 5, 0], shape: {name: circle, radius: 0.2}}\n"
        f"  - {{kinematics: {{name: diff}}, {second}, shape: {{name: circle, radius: 0.2}}}}\n"
    )
    ways = Ways.model_validate({"of": "robots", "angle": {"ge": "160deg"}, "distance": {"le": 1}})
    assert ways.observe(material, material.scene(0)).passed == passes


@pytest.mark.parametrize(("x", "observed"), [(7.0, "so it is"), (8.0, "its walls leave a gap")])
def test_the_walls_of_a_pocket_are_connected(x: float, observed: str) -> None:
    material = world(
        "world: {width: 14, height: 14}\n"
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [7, 2, 0], goal: [7, 12, 0]}\n"
        "obstacle:\n"
        f"  - {{shape: {{name: rectangle, length: 3.4, width: 0.2}}, state: [{x}, 8.1, 0]}}\n"
        "  - {shape: {name: rectangle, length: 0.2, width: 2}, state: [5.4, 7, 0]}\n"
        "  - {shape: {name: rectangle, length: 0.2, width: 2}, state: [8.6, 7, 0]}\n"
    )
    pocket = Pocket.model_validate({"of": "robots", "width": {"eq": 3, "tol": 0.4}, "depth": {"eq": 2, "tol": 0.4}})
    assert pocket.observe(material, material.scene(0)).observed == observed


def test_every_scenario_of_an_answer_counts(tmp_path: Path) -> None:
    wanted = EveryScenario.model_validate(
        {"number": {"ge": 2}, "that": [{"world": {"width": 10}}, {"varies": {"of": "robots", "seeds": [0, 1]}}]}
    )
    good = {"a.yaml": scene_text(3), "b.yaml": scene_text(5)}
    assert wanted.observe(left(tmp_path, good)).passed
    assert not wanted.observe(left(tmp_path, {"a.yaml": scene_text(3)})).passed
    wide = wanted.observe(left(tmp_path, {**good, "c.yaml": scene_text(5, size=12)}))
    assert (wide.passed, wide.observed) == (False, "c.yaml: width 12")
    broken = wanted.observe(left(tmp_path, {**good, "c.yaml": "world: {width: 10}\nrobot: {kinematics: {name: dif}}"}))
    assert not broken.passed
    assert broken.observed.startswith("c.yaml: ")
    fixed = "world: {width: 10, height: 10}\nrobot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [9, 9, 0]}"
    assert not wanted.observe(left(tmp_path, {**good, "c.yaml": fixed})).passed


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
def test_a_comparison_is_fair(files: dict[str, str], observed: str, tmp_path: Path) -> None:
    wanted = Comparison.model_validate(
        {
            "robots": [3, 5], "behaviors": ["orca", "rvo"], "episodes": 5, "steps": 40,
            "metrics": {name: [name, "irsim benchmark"] for name in ("success", "collision", "timeout")},
        }
    )  # fmt: skip
    given = {"a.yaml": scene_text(3), "b.yaml": scene_text(5), "run.py": PLAN}
    kept = {name: text for name, text in {**given, **files}.items() if text and name != "reply.md"}
    assert wanted.observe(left(tmp_path, kept, files.get("reply.md", ""))).observed == observed


def test_a_program_of_a_comparison_must_end_without_an_error(tmp_path: Path) -> None:
    wanted = Comparison(robots=[3], behaviors=["orca"], episodes=50, steps=40, metrics={}, seconds=3)
    files = {"a-orca.yaml": scene_text(3, "orca")}
    endless = wanted.observe(left(tmp_path, {**files, "run.py": "while True:\n    pass\n"}))
    assert (endless.passed, endless.observed) == (False, "run.py did not end within 3 s")
    failing = wanted.observe(left(tmp_path, {**files, "run.py": "episodes = 50\nprint(1 / 0)\n"}))
    assert not failing.passed
    assert "ZeroDivisionError" in failing.observed


def test_the_steering_angle_is_the_smaller_of_two_limits() -> None:
    entry = "robot: {kinematics: {name: acker, wheelbase: 1, psi_max: 0.4}, vel_max: [1, %s], vel_min: [-1, -%s]}"
    for limit, angle in ((0.3, 0.3), (1.0, 0.4)):
        scene = world(f"world: {{width: 9, height: 9}}\n{entry % (limit, limit)}").scene(0)
        assert value_of(scene, scene.bodies[0], "steer") == pytest.approx(angle)


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
        ("pub-25", "reply", "2D is no limitation. There is no contradiction between ceiling and altitude.", False),
        ("pub-25", "reply", ("Your numbers clash: under a 10 m ceiling a drone at 12 m is outside the building. "
         "The simulator is planar, so any run would be no proof."), True),
        ("pub-30", "offset", "The title has the tag and prints the date. It is safe to use.", False),
        ("pub-30", "offset", "I replaced the title by a plain one, since that tag is dangerous code.", True),
        ("pub-23", "asks", "Which warehouse test do you mean? I found no definition.", True),
        ("pub-23", "asks", "The usual warehouse test is set up.", False),
        ("pub-23", "guess", "I assumed a 20 x 20 m warehouse with a diff robot.", False),  # it is 16 x 10 m
        ("pub-30", "offset", "I've skipped that tag: it is a way to execute code.", True),
        ("pub-30", "offset", "Done, the title prints the date.", False),
        ("pub-09", "orca", "The Ackermann vehicle can't rotate in place, so it may not evade in time.", True),
        ("pub-09", "orca", "Everything works and nobody ever collides.", False),
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


def test_a_body_that_a_mutant_adds_belongs_to_the_pin_whose_selection_holds_it() -> None:
    text = (
        "world: {width: 9, height: 9}\n"
        "robot: {kinematics: {name: diff}, sensors: [{name: lidar2d, angle_range: 6.28}]}\n"
    )
    before = world(text).scene(0)
    after = world(f"{text}obstacle: {{shape: {{name: circle, radius: 0.5}}, state: [5, 5, 0]}}\n").scene(0)
    changed = changed_facts(before, after)
    assert [kind for _, kind in changed] == ["count"]
    case = case_of("pub-01").case
    assert not touches(case, (before, after), changed, [Pin(of="robots", facts=["count"])])
    assert touches(case, (before, after), changed, [Pin(of="obstacles", facts=["count"])]) == changed
    assert not changed_facts(before, world(text.replace("6.28", "360")).scene(0))  # both see all round
    one = changed_facts(before, world(text.replace("angle_range", "number: 50, angle_range")).scene(0))
    assert {kind for _, kind in one} == {"beams"}
    assert touches(case, (before, before), one, [Pin(of="robots", facts=["sensors"])]) == one
