"""ONNX models where onnxruntime is not installed."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import pytest

from irsim.common import extras
from irsim.policies.networks import open_network


def test_without_the_extra_the_command_that_installs_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def find(name: str, *rest: Any) -> Any:
        return None if name in ("onnx", "onnxruntime") else importlib.util.find_spec(name, *rest)

    monkeypatch.setattr(extras, "find_spec", find)
    (tmp_path / "net.onnx").write_bytes(b"anything")
    with pytest.raises(
        extras.ExtraError, match=r"onnx and onnxruntime are not installed.*pip install 'irsim-mcp\[onnx\]'"
    ):
        open_network(tmp_path / "net.onnx")
