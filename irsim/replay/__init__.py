"""A recorded run as one HTML page that needs nothing else: ``irsim.replay("last")``.

``irsim.replay(…)``, the function, and this package have the same name: calling the package calls the function.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any


class _CallablePackage(ModuleType):
    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Write a page; see :func:`irsim.replay.export.replay`."""
        from irsim.replay.export import replay

        return replay(*args, **kwargs)


sys.modules[__name__].__class__ = _CallablePackage
