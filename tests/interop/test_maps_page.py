"""The page about maps: its commands and its program work as written."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from tests.bridges.maps.flat import flat, house, storey, write_glb, y_up
from tests.bridges.maps.navmesh_files import TWO_ROOMS, mesh_set, tile

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("meshes")]
PAGE = Path(__file__).resolve().parents[2] / "skills" / "irsim-runner" / "bridges" / "maps.md"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_its_commands_and_its_program(tmp_path, monkeypatch) -> None:
    pytest.importorskip("trimesh")
    monkeypatch.chdir(tmp_path)
    write_glb(tmp_path / "flat.glb", flat())
    write_glb(tmp_path / "house.glb", house())
    z_up = storey()
    lying = np.stack([z_up[..., 0], -z_up[..., 2], z_up[..., 1]], axis=-1)
    write_glb(tmp_path / "scene.glb", lying)  # which the writer turns back: z is up in the file
    assert np.ptp(y_up(lying)[..., 2]) < 3.5
    (tmp_path / "scene.navmesh").write_bytes(mesh_set(tile(TWO_ROOMS), version=2))
    for line in "\n".join(blocks("bash")).splitlines():
        words = shlex.split(line, comments=True)
        if words[:1] == ["irsim"]:
            done = CliRunner().invoke(app, words[1:])
            assert done.exit_code == 0, (line, done.output)
    assert (tmp_path / "bed.yaml").is_file()
    [program] = blocks("python")
    seen: dict[str, np.ndarray] = {}
    exec(program, seen)
    assert seen["points"] == pytest.approx(np.array([[1, 1.2, -2], [1.5, 1.2, -2]]), abs=0.01)
    assert seen["back"] == pytest.approx(np.array([[1, 2, 1.2], [1.5, 2, 1.2]]), abs=1e-6)
    assert seen["matrices"].shape == (2, 4, 4)
