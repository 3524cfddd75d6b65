"""``placed``: bodies stand as a table says, one for each row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import field_validator

from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary
from irsim_evals.grader.properties import PROPERTIES, value_of

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("placed")
class Placed(ScenePredicate):
    """Each row of a table describes exactly one body of a selection, and each of its bodies has a row."""

    stage = "relations"

    of: str
    """Name of the selection."""
    rows: list[dict[str, Match]]
    """For each row: property → accepted values."""

    @field_validator("rows")
    @classmethod
    def _known(cls, rows: list[dict[str, Match]]) -> list[dict[str, Match]]:
        for name in {name for row in rows for name in row}:
            if name not in PROPERTIES:
                raise ValueError(f"no property is called {name!r}; there are {', '.join(PROPERTIES)}")
        return rows

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Find a body for each row."""
        bodies = material.bodies(scene, self.of)
        expected = f"{self.of}: one for each of {len(self.rows)} rows"
        fits = [[k for k, body in enumerate(bodies) if self._fits(scene, body, row)] for row in self.rows]
        row_of: dict[int, int] = {}
        open_rows = [row for row in range(len(self.rows)) if not _assign(row, fits, row_of, set())]
        odd = [body for k, body in enumerate(bodies) if k not in row_of]
        if not open_rows and not odd:
            return Observation(True, expected, f"all {len(bodies)}")
        words = ["; ".join(f"{name} {match.words()}" for name, match in self.rows[row].items()) for row in open_rows]
        observed = "".join(f"no body with {text}. " for text in words[:3])
        if odd:
            observed += "in no row: " + summary([(body, self._values(scene, body)) for body in odd])
        return Observation(
            False,
            expected,
            observed,
            f"{odd[0].entry}.state" if odd else None,
            marks=[Mark(points=[list(body.position)], text=body.name) for body in odd],
        )

    def _fits(self, scene: Scene, body: Body, row: dict[str, Match]) -> bool:
        return all(matches(match, value_of(scene, body, key), PROPERTIES[key].kind) for key, match in row.items())

    def _values(self, scene: Scene, body: Body) -> list[Any]:
        return [value_of(scene, body, name) for name in (self.rows[0] if self.rows else ())]


def _assign(row: int, fits: list[list[int]], row_of: dict[int, int], tried: set[int]) -> bool:
    """Give a row one of the bodies that fit it, moving other rows to other bodies where that helps."""
    for k in fits[row]:
        if k in tried:
            continue
        tried.add(k)
        if k not in row_of or _assign(row_of[k], fits, row_of, tried):
            row_of[k] = row
            return True
    return False
