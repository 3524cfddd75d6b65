"""A fixture for tests of learning."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Any

import pytest

from irsim.common.child import Child
from tests.warm import warm


@pytest.fixture
def warm_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Worker processes have loaded already what takes long; they open the shared memory instead of inheriting it."""

    def start(command: Sequence[str], *, pass_fds: Sequence[int], **options: Any) -> Child:
        *words, code = command
        opened = [f"os.dup2(os.open('/proc/{os.getpid()}/fd/{file}', os.O_RDWR), {file})" for file in pass_fds]
        return Child(warm([*words, "; ".join(["import os", *opened, code])]), **options)

    if sys.platform == "linux":
        monkeypatch.setattr("irsim.learning.workers.process.Child", start)
