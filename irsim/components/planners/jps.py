"""``jps``: jump point search on a grid."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.components.planners._options import GridPlanner
from irsim.options.registry import PLANNERS


class Jps(GridPlanner):
    """Jump point search: the paths of A*, found faster by skipping cells without a choice."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "jps"}]}

    name: Literal["jps"] = "jps"


PLANNERS.register(Jps, kernel=core.JpsOptions)
