"""Options of behaviors that were fitted to recorded people: the values of ``people``.

Each set was sought in one recording, of ETH BIWI (``eth``) or of UCY (``zara01``), such that people who know where they
want to go are most like the recorded ones: in their places over 4.8 s, in their distances to the nearest other, and in
the share of them that touch others. ``results/pedestrians.md`` of the skill irsim-benchmark is their card: how alike
people are in the recording that was fitted and in others. ``python -m tests.benchmarks.pedestrians.fit FOLDER`` finds
the same numbers again.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import model_validator

from irsim.components.options import BehaviorOptions
from irsim.options.presets import with_preset

__all__ = ["FITTED", "FittedOptions", "People"]

People = Literal["eth", "zara01"]
"""A recording to which options were fitted."""
FITTED: Mapping[str, Mapping[str, Mapping[str, float]]] = {
    "sfm": {
        "eth": {
            "relaxation_time": 0.706,
            "force_factor_social": 9.89,
            "lambda_importance": 3.71,
            "gamma": 0.106,
            "n_angular": 2.1,
            "n_velocity": 4.44,
        },
        "zara01": {
            "relaxation_time": 2.62,
            "force_factor_social": 6.81,
            "lambda_importance": 5.27,
            "gamma": 0.0771,
            "n_angular": 4.31,
            "n_velocity": 7.66,
        },
    },
    "orca": {
        "eth": {"timeHorizon": 3.4, "safe_radius": 0.124, "neighborDist": 12.0},
        "zara01": {"timeHorizon": 4.87, "safe_radius": 0.0621, "neighborDist": 6.27},
    },
}
"""Behavior -> recording -> options."""


class FittedOptions(BehaviorOptions):
    """Keys of a behavior for which options were fitted to recorded people."""

    people: People | None = None
    """Options fitted to recorded people; keys beside it win."""

    @model_validator(mode="before")
    @classmethod
    def _take_fitted(cls, given: Any) -> Any:
        return with_preset(given, "people", FITTED[str(cls.model_fields["name"].default)], dict)
