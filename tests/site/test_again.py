"""The site that is built again is the same to the byte, wherever and in whatever order it is built."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.site, pytest.mark.one_python]

BUILD = Path(__file__).resolve().parents[2] / ".ci/site/build.py"


def contents(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_two_builds_are_equal_to_the_byte(html: Path, tmp_path: Path) -> None:
    env = {**os.environ, "PYTHONHASHSEED": "7", "TZ": "Asia/Tokyo"}
    subprocess.run([sys.executable, BUILD, tmp_path / "again"], check=True, capture_output=True, timeout=900, env=env)
    first, second = contents(html), contents(tmp_path / "again" / "html")
    assert sorted(first) == sorted(second)
    assert [name for name in sorted(first) if first[name] != second[name]] == []
