"""``manual``: places given by ``state`` and ``goal``."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from irsim.components.options import DistributionOptions
from irsim.options.registry import DISTRIBUTIONS


class Manual(DistributionOptions):
    """Place objects by `state` and `goal` of the entry: one vector for all objects, or a list with one per object."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "manual"}]}

    name: Literal["manual"] = "manual"


@DISTRIBUTIONS.register(Manual)
def place(options: Manual, count: int, world: Any) -> None:
    """Nothing to compute: poses and goals come from the entry."""
    return None
