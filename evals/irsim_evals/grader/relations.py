"""Accepted values that depend on the answer: ``ge: "= robots.width + 0.1"`` compares with what its robots are."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator
from typing import Any

from pydantic_core import PydanticCustomError

from irsim.bundled.templates.fill import evaluate
from irsim.options.base import problem
from irsim_evals.grader.matching import Match, Place, Relation
from irsim_evals.grader.material import Material
from irsim_evals.grader.predicates._base import Predicate
from irsim_evals.grader.predicates.world import WORLD_KINDS, world_value
from irsim_evals.grader.properties import PROPERTIES, value_of
from irsim_evals.grader.scene import GradedScene
from irsim_evals.grader.selection import BUILT_IN
from irsim_evals.grader.words import unknown

__all__ = ["related", "unknown_words"]

_SAME = 1e-6
"""Difference of two values that counts as none."""


def related(predicate: Any, material: Material, scene: GradedScene) -> Any:
    """A predicate in which every relation is replaced by its number in a world.

    Raises:
        LookupError: A relation is about no body, about a property that a body has not, or about one that differs.
    """

    def resolve(value: Any) -> Any:
        if isinstance(value, Match) and value.relations():
            return value.model_copy(update={k: _number(k, r, material, scene) for k, r in value.relations().items()})
        if isinstance(value, dict):
            return {key: resolve(item) for key, item in value.items()}
        if isinstance(value, list):
            return [resolve(item) for item in value]
        return value

    given = {name: getattr(predicate, name) for name in predicate.model_fields_set}
    made = {name: resolve(value) for name, value in given.items()}
    return predicate.model_copy(update=made) if made != given else predicate


def unknown_words(predicate: Predicate, selections: Collection[str]) -> Iterator[tuple[Place, PydanticCustomError]]:
    """Places and errors of relations that name unknown things or need a world that the predicate lacks."""
    for place, relation in _relations_in(dict(predicate), (predicate.name,)):
        if predicate.subject not in ("scene", "episode"):
            message = f"an assertion about {predicate.subject} has no world whose properties it could name"
            yield place, problem("invalid-value", message, fix="write a number")
        for selection, name in relation.references:
            kind, known = ("property of the world", WORLD_KINDS) if selection == "world" else ("property", PROPERTIES)
            if selection not in (own := [*selections, *BUILT_IN, "world"]):
                yield place, unknown("selection", selection, own)
            elif name not in known:
                yield place, unknown(kind, name, list(known), "irsim-evals properties explains them all")


def _relations_in(value: Any, place: Place) -> Iterator[tuple[Place, Relation]]:
    if isinstance(value, Match):
        yield from (((*place, key), relation) for key, relation in value.relations().items())
    elif isinstance(value, (dict, list, Predicate)):
        for key, item in enumerate(value) if isinstance(value, list) else dict(value).items():
            yield from _relations_in(item, (*place, key))


def _number(key: str, relation: Relation, material: Material, scene: GradedScene) -> float:
    """The value of a relation; where bodies differ, the strictest value, so that a bound holds for each of them."""
    ranges = [_range(material, scene, selection, name) for selection, name in relation.references]
    results = [float(evaluate(relation.expression, dict(zip(relation.names, values, strict=True))))
               for values in itertools.product(*map(set, ranges))]  # fmt: skip
    if key not in ("ge", "le") and max(results) - min(results) > _SAME:
        raise LookupError(f"{relation} is {min(results):g} to {max(results):g}: no single value")
    return min(results) if key == "le" else max(results)


def _range(material: Material, scene: GradedScene, selection: str, name: str) -> tuple[float, float]:
    """The smallest and the largest value of a property among the bodies of a selection."""
    if selection == "world":
        values = {"the world": world_value(scene, name)}
    else:
        values = {body.name: value_of(scene, body, name) for body in material.bodies(scene, selection)}
    if not values:
        raise LookupError(f"no body is in {selection}")
    without = [who for who, value in values.items() if not isinstance(value, (int, float))]
    if without:
        raise LookupError(f"{without[0]} has no {name}")
    return min(values.values()), max(values.values())
