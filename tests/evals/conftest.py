"""Where the evals are, and short ways to a case, to an answer that is opened, and to what a predicate sees of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.cases.instance import Instance, instance_of
from irsim_evals.grader.episode import Episode, run_episode
from irsim_evals.grader.material import Material
from irsim_evals.grader.predicates._base import Observation, registered
from irsim_evals.grader.selection import Selector

ROOT = Path(__file__).resolve().parents[2]
EVALS = ROOT / "evals"
SKILLS = sorted(path.parent.name for path in (ROOT / "skills").glob("*/SKILL.md"))
RIGHT = """
world: {width: 14, height: 9}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.35}
  state: [2, 1.5, 1.5708]
  goal: [12, 7.5, 0]
  behavior: {name: dash}
"""
"""A right answer to ``pub-01``."""


def made_up(*assertions: dict[str, Any], **keys: Any) -> Instance:
    """A case with some assertions about the start, and further keys."""
    raw = {"id": "made-up", "title": "x", "category": ["basic"], "level": 1, "prompt": "x", "assert": [*assertions]}
    return instance_of(raw | keys)


def world(text: str, reply: str = "", **selectors: dict[str, Any]) -> Material:
    """An answer that is one scenario."""
    scenario = read(load_text(text)).scenario
    chosen = {name: Selector.model_validate(value) for name, value in selectors.items()}
    return Material(scenario=scenario, selectors=chosen, texts={"scenario.yaml": text}, reply=reply)


def episode(material: Material, seconds: float) -> Episode:
    assert material.scenario is not None
    return run_episode(material.scenario, 0, seconds)


def seen(material: Material, name: str, keys: dict[str, Any], seconds: float = 0.0) -> Observation:
    """Observation of a predicate about an answer; predicates about episodes get one of that length."""
    predicate: Any = registered()[name].model_validate(keys)
    subject = {"scene": lambda: (material.scene(0),), "episode": lambda: (episode(material, seconds),)}
    observation: Observation = predicate.observe(material, *subject.get(predicate.subject, tuple)())
    return observation
