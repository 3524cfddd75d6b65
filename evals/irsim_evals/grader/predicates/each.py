"""``each``: what every body of a selection has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import model_validator

from irsim_evals.grader.matching import Match, Quantity, matches
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary
from irsim_evals.grader.properties import PROPERTIES, value_of, yaml_path

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("each")
class Each(ScenePredicate):
    """Every body of a selection has some properties. An empty selection fails."""

    of: str
    """Name of the selection."""
    has: dict[str, Match]
    """Property → accepted values."""
    share: Quantity = 1.0
    """Share of the bodies that must have them."""

    @model_validator(mode="after")
    def _known(self) -> Each:
        for name in self.has:
            if name not in PROPERTIES:
                raise ValueError(f"no property is called {name!r}; there are {', '.join(PROPERTIES)}")
        return self

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Look at each of them."""
        bodies = material.bodies(scene, self.of)
        words = ", ".join(f"{name} {match.words()}" for name, match in self.has.items())
        least = "each" if self.share == 1 else f"at least {self.share:.0%}"
        expected = f"{self.of}: {least} has {words}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        wrong: list[tuple[Any, Any]] = []
        where, bad = None, 0
        for body in bodies:
            values = {name: value_of(scene, body, name) for name in self.has}
            off = [name for name, match in self.has.items() if not matches(match, values[name], PROPERTIES[name].kind)]
            bad += bool(off)
            if off:
                where = where or yaml_path(body, off[0])
                wrong.append((body, values[off[0]] if len(self.has) == 1 else {k: values[k] for k in off}))
        passed = bad <= (1 - self.share) * len(bodies) + 1e-9
        observed = summary(wrong) if wrong else f"all {len(bodies)}"
        return Observation(passed, expected, observed, None if passed else where)
