from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def site() -> Path:
    """The folder of a built site, ``source`` and ``html``: the session `docs` builds it and names it in IRSIM_SITE."""
    return Path(os.environ["IRSIM_SITE"])


@pytest.fixture(scope="session")
def html(site: Path) -> Path:
    return site / "html"


@pytest.fixture(scope="session", autouse=True)
def writer() -> None:
    """Modules of the script that writes the site can be imported."""
    folder = str(ROOT / ".ci" / "site")
    if folder not in sys.path:
        sys.path.insert(0, folder)
