"""Draw the picture of each template: ``python -m tests.bundled.draw [NAME ...]``."""

from __future__ import annotations

import sys
from pathlib import Path

from irsim.api.take_snapshot import snapshot
from irsim.bundled import templates

__all__ = ["draw"]

SIZE = 400


def draw(name: str, target: Path) -> None:
    """Draw the start of a template as agents see it, with the first seed."""
    target.write_bytes(snapshot(templates.scenario_file(name), seed=0, size=SIZE).png)


if __name__ == "__main__":
    for chosen in sys.argv[1:] or templates.names():
        draw(chosen, templates.picture_file(chosen))
