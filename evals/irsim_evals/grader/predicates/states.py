"""``states``: the reply gives the value of a property, and the world agrees."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from pydantic import field_validator

from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.properties import value_of, yaml_path
from irsim_evals.grader.units import UNITS, quantity

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material

_NUMBER = re.compile(r"(?<![\w.,])(\d+(?:[.,]\d+)?)\s*(km/h|m/s|cm|mm|m|°|deg|rad)?(?![\w])")
_AROUND = 100
"""Number of characters before and behind a about in which its value is looked for."""


@register("states")
class States(AnswerPredicate):
    """The reply gives the value that a property of a body has in the world, near words that name the about."""

    of: str
    """Name of the selection; its first body counts."""
    property: str
    """Name of the property."""
    about: str
    """Regular expression for words near the value, ignoring case."""
    factors: list[Quantity] = [1.0]
    """What is stated may be the value times one of these: 2 allows a diameter for a radius."""

    @field_validator("about")
    @classmethod
    def _compiles(cls, pattern: str) -> str:
        re.compile(pattern)
        return pattern

    def observe(self, material: Material) -> Observation:
        """Look for the number."""
        scene = material.scene(0)
        bodies = material.bodies(scene, self.of)
        if not bodies:
            return Observation(False, f"the reply states {self.property} of {self.of}", f"{self.of}: no body")
        value = value_of(scene, bodies[0], self.property)
        expected = f"the reply states {self.property} of {self.of} ({show(value)}) near /{self.about}/"
        if not isinstance(value, (int, float)):
            return Observation(False, expected, f"{bodies[0].name} has none", yaml_path(bodies[0], self.property))
        seen = _numbers(re.sub(r"\s+", " ", material.reply), self.about)
        wanted = [value * factor for factor in self.factors]
        passed = any(abs(a - b) <= 0.02 * abs(b) + 1e-9 for a in seen for b in wanted)
        observed = ", ".join(show(number) for number in seen[:8]) or "no number there"
        return Observation(passed, expected, observed, yaml_path(bodies[0], self.property))


def _numbers(reply: str, about: str) -> list[float]:
    """The numbers near a about in SI units."""
    found: list[float] = []
    for mention in re.finditer(about, reply, re.IGNORECASE):
        part = reply[max(0, mention.start() - _AROUND) : mention.end() + _AROUND]
        for number, unit in _NUMBER.findall(part):
            plain = number.replace(",", ".")
            known = all(name in UNITS for name in unit.split("/"))
            found.append(quantity(f"{plain} {unit}") if known else float(plain))
    return found
