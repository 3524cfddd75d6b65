"""``comparison``: scenarios, seeds and horizon of a comparison of behaviors are the same for all of them."""

from __future__ import annotations

import ast
import itertools
import re
from typing import TYPE_CHECKING, Any

from irsim_evals.grader.matching import Quantity
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.predicates.every_scenario import opened, scenario_names
from irsim_evals.grader.programs import run_program

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material

_SEEDS = (0, 1)
"""Seeds of the worlds that are compared."""
_UNENDED = "did not end within"


@register("comparison")
class Comparison(AnswerPredicate):
    """Behaviors are compared fairly: with the same scenarios but for the behavior, the same seeds, the same horizon."""

    stage = "relations"

    robots: list[int]
    """Numbers of robots; there is at least one scenario for each."""
    behaviors: list[str]
    """Behaviors that are compared: each has a file of its own for each number of robots, or is named in the plan, which
    is all that is written beside the scenarios: programs, settings, the reply."""
    episodes: int
    """Number of episodes, which the plan names."""
    steps: int
    """Horizon in steps, which the plan names or every scenario has."""
    metrics: dict[str, list[str]]
    """Name → regular expressions, one of which occurs in the plan."""
    seconds: Quantity = 0.0
    """How long each program is tried [s]: it may take longer, but it must not end with an error."""

    def observe(self, material: Material) -> Observation:
        """Compare the files and search the plan."""
        expected = (
            f"{', '.join(self.behaviors)} with {', '.join(map(str, self.robots))} robots, {self.episodes} episodes of "
            f"{self.steps} steps each, and {', '.join(self.metrics)}"
        )
        problem = self._files(material) or self._plan(material) or self._programs(material)
        return Observation(not problem, expected, problem or "so it is")

    def _files(self, material: Material) -> str:
        """What is wrong with the scenarios; empty if nothing is."""
        groups: dict[int, dict[str, Material]] = {}
        limits = set()
        for name in scenario_names(material):
            one = opened(material, name)
            if isinstance(one, str):
                return f"{name}: {one}"
            scene = one.scene(0)
            groups.setdefault(len(scene.robots), {})[name] = one
            limits.add(_steps(scene.world.time_limit, scene.world.step_time))
        plan = plan_of(material)
        for number in self.robots:
            files = groups.get(number, {})
            if not files:
                return f"no scenario with {number} robots, but with {', '.join(map(str, sorted(groups))) or 'none'}"
            for a, b in itertools.pairwise(files):
                odd = _differing(_facts(files[a], layout=True), _facts(files[b], layout=True))
                if odd:
                    return f"{a} and {b} differ in {odd}, too"
            for behavior in self.behaviors:
                own = any({body.behavior for body in one.scene(0).robots} == {behavior} for one in files.values())
                if not own and not re.search(rf"\b{behavior}\b", plan, re.IGNORECASE):
                    return f"nothing runs {behavior} with {number} robots"
        firsts = [next(iter(groups[number].items())) for number in self.robots]
        for (a, one), (b, other) in itertools.pairwise(firsts):
            odd = _differing(_facts(one), _facts(other))
            if odd:
                return f"{a} and {b} differ in {odd}, too"
        if limits != {self.steps} and not re.search(rf"(?<![\d.]){self.steps}(?![\d.])", plan):
            return f"no horizon of {self.steps} steps; by the scenarios {', '.join(map(str, limits))}"
        return ""

    def _plan(self, material: Material) -> str:
        """What the plan lacks; empty if nothing."""
        plan = plan_of(material)
        if not re.search(rf"(?<![\d.]){self.episodes}(?![\d.])", plan):
            return f"nothing says that there are {self.episodes} episodes"
        for metric, ways in self.metrics.items():
            if not any(re.search(way, plan, re.IGNORECASE) for way in ways):
                return f"nothing reports the rate of {metric}"
        return ""

    def _programs(self, material: Material) -> str:
        """What is wrong with the programs; empty if nothing is, or if there are none."""
        for name in sorted(name for name in material.texts if name.endswith(".py")):
            for key in ("seeds", "steps"):
                values = _arguments(material.texts[name], key)
                if len(values) > 1:
                    return f"{name} has different {key}: {', '.join(sorted(values))}"
            if self.seconds > 0:
                done = run_program(material.folder(), name, self.seconds)
                if not done.passed and _UNENDED not in done.why:
                    return done.why
        return ""


def plan_of(material: Material) -> str:
    """All that is written beside the scenarios: programs, settings, the reply."""
    scenarios = set(scenario_names(material))
    texts = [text for name, text in material.texts.items() if name not in scenarios and name not in material.given]
    return "\n".join([*texts, material.reply])


def _steps(limit: float | None, step_time: float) -> int | None:
    return None if limit is None else round(limit / step_time)


def _facts(one: Material, *, layout: bool = False) -> dict[str, Any]:
    """What must be equal in scenarios that are compared.

    Args:
        one: The scenario.
        layout: Whether starts and goals count, and how many robots there are.
    """
    scene = one.scene(_SEEDS[0])
    world = scene.world
    robots = [
        [body.kinematics, body.shape, body.extent, body.limits, body.threshold, body.arrive_mode, body.sensors]
        for body in scene.robots
    ]
    found: dict[str, Any] = {
        "the size of the world": scene.bounds,
        "the time of a step": [world.step_time, world.sample_time],
        "the time limit": world.time_limit,
        "the modes of the world": [world.collision_mode, world.step_mode, world.control_mode, world.boundary],
        "the map": str(world.obstacle_map),
        "the obstacles": [] if scene.env.scenario.placements else [body.footprint.wkt for body in scene.solids],
        "drive, shape, limits or sensors of a robot": sorted({repr(robot) for robot in robots}),
    }
    if layout:
        found["starts and goals"] = [
            [body.pose[:2], body.goals] for seed in _SEEDS for body in one.scene(seed).bodies if not body.static
        ]
    return found


def _differing(a: dict[str, Any], b: dict[str, Any]) -> str:
    """The first fact that differs; empty if there is none."""
    return next((name for name in a if a[name] != b[name]), "")


def _arguments(text: str, key: str) -> set[str]:
    """The different values that a program gives for an argument of any of its calls."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return {ast.unparse(word.value) for call in calls for word in call.keywords if word.arg == key}
