"""``every_scenario``: assertions about each scenario of an answer that has several."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pydantic import field_validator

from irsim.diagnostics.errors import IrsimError
from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, Predicate, register, registered

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material

_SEED = 0
"""Seed of the worlds that are looked at."""


@register("every_scenario")
class EveryScenario(AnswerPredicate):
    """Every scenario file that the agent left is valid and fulfils some assertions about its world."""

    stage = "facts"

    number: Match = Match(ge=1)
    """Accepted numbers of scenario files."""
    that: list[dict[str, Any]]
    """Assertions about the world: each is the name of a predicate with its keys."""

    @field_validator("that")
    @classmethod
    def _known(cls, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        for item in value:
            _predicate(item)
        return value

    def observe(self, material: Material) -> Observation:
        """Open each of them."""
        names = scenario_names(material)
        expected = f"scenarios: {self.number.words()}, each as wanted"
        if not matches(self.number, len(names), "count"):
            return Observation(False, expected, f"{len(names)}: {', '.join(names[:6])}")
        for name in names:
            one = opened(material, name)
            if isinstance(one, str):
                return Observation(False, expected, f"{name}: {one}", name)
            for item in self.that:
                predicate: Any = _predicate(item)
                scene = predicate.subject == "scene"
                found: Observation = predicate.observe(one, one.scene(_SEED)) if scene else predicate.observe(one)
                if not found.passed:
                    words = f"{name}: {found.expected}", f"{name}: {found.observed}"
                    return Observation(False, *words, found.yaml_path, _SEED, found.marks)
        return Observation(True, expected, f"{len(names)} scenarios")


def scenario_names(material: Material) -> list[str]:
    """Names of the scenario files that the agent left."""
    from irsim_evals.grader.artefact import scenarios_in  # it imports the cases, which import the predicates

    return sorted(name for name in scenarios_in(material.texts) if name not in material.given)


def opened(material: Material, name: str) -> Material | str:
    """Another scenario of the same answer; what is wrong with it, if it cannot be opened."""
    from irsim_evals.grader.grade import LIMITS

    document = load_text(material.texts[name], limits=LIMITS)
    if document.fatal:
        return "; ".join(item.message for item in document.problems[:2])
    reading = read(document, limits=LIMITS)
    bad = [item for item in reading.diagnostics if item.severity == "error" or item.code == "unknown-key"]
    if reading.scenario is None or bad:
        return "; ".join(item.message for item in bad[:2])
    made = replace(material, main=name, scenario=reading.scenario, document=document, _scenes={})
    try:
        made.scene(_SEED)
    except IrsimError as error:
        return str(error).splitlines()[0]
    return made


def _predicate(item: dict[str, Any]) -> Predicate:
    if len(item) != 1:
        raise ValueError("give exactly one predicate in each item")
    ((name, keys),) = item.items()
    known = registered()
    if name not in known or known[name].subject not in ("scene", "seeds"):
        raise ValueError(f"no predicate about a world is called {name!r}")
    return known[name].model_validate(keys)
