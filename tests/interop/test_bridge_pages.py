"""The first commands of the pages whose extras are installed here."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.skills.test_bridge_pages import MODULES, try_page

pytestmark = pytest.mark.interop


@pytest.mark.parametrize("page", sorted({"mujoco", "ros2", "usd"} & set(MODULES)))
def test_a_page_begins_with_commands_that_work(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip(MODULES[page])
    monkeypatch.chdir(tmp_path)
    try_page(page)
