"""Where features are found: a module of their name, or an installed plug-in; and what is said if neither works."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import pytest
from pydantic import BaseModel

from irsim.options.registry import Registry


class Boat(BaseModel):
    name: Literal["boat"] = "boat"


class Entry:
    """An entry point of an installed package."""

    def __init__(self, registry: Registry) -> None:
        self._registry = registry

    def load(self) -> None:
        self._registry.register(Boat)(len)


@pytest.fixture
def registry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Registry]:
    (tmp_path / "own_drives").mkdir()
    (tmp_path / "own_drives" / "__init__.py").write_text("")
    (tmp_path / "own_drives" / "hovercraft.py").write_text("import a_library_that_nobody_has\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield Registry("drive", "own_drives", "own.drives")
    for name in ("own_drives.hovercraft", "own_drives"):
        sys.modules.pop(name, None)


def test_features_of_plug_ins_are_loaded_when_they_are_asked_for(registry: Registry) -> None:
    assert registry.get("boat") is None
    registry._plugins = {"boat": Entry(registry)}
    assert registry.names() == ["boat", "hovercraft"]
    feature = registry.get("boat")
    assert feature is not None
    assert (feature.options, feature.function) == (Boat, len)


def test_a_feature_without_a_function_is_known_and_not_simulated(registry: Registry) -> None:
    registry.register(Boat)
    feature = registry.get("boat")
    assert feature is not None
    assert (feature.simulated, feature.origin) == (False, __name__)


def test_a_feature_that_lacks_a_library_is_not_called_unknown(registry: Registry) -> None:
    with pytest.raises(ModuleNotFoundError, match="a_library_that_nobody_has"):
        registry.get("hovercraft")
    assert registry.get("submarine") is None
