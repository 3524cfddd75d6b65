"""``irsim policies --for``: the policies that suit a scene, with reasons."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from tests.cli.conftest import Run
from tests.episodes.test_suitability import PILLARS, scene


def test_the_command_ranks_policies_with_reasons_and_the_line_of_the_best(irsim: Run, tmp_path: Path) -> None:
    file = tmp_path / "hall.yaml"
    file.write_text(scene(PILLARS), encoding="utf-8")
    shown = irsim("policies", "--for", str(file)).stdout
    assert shown.splitlines()[1].startswith("orca")
    assert "best: behavior: {name: orca}" in shown
    data: list[dict[str, Any]] = json.loads(irsim("policies", "--for", str(file), "--json").stdout)
    assert {"policy", "origin", "fits", "reason", "line", "misfits"} == set(data[0])
    assert "takes no name" in irsim("policies", "sarl", "--for", str(file), code=2).stderr
    assert "people: [1, 10]" in irsim("policies", "sarl").stdout
