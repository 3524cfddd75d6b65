"""Reading, running and explaining one episode.

``irsim.episodes(…)``, the function, and this package have the same name: calling the package calls the function.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

from irsim.common.lazy import call_home


class _CallablePackage(ModuleType):
    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Run episodes: ``irsim.episodes(…)`` after something has imported this package, which then has that name."""
        return call_home("irsim.api.run_controller:episodes", *args, **kwargs)


sys.modules[__name__].__class__ = _CallablePackage
