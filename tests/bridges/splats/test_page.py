"""The page with splats and a run, as a file; tests/interop/splats opens it in a browser."""

from __future__ import annotations

import base64
import json
import re
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim.bridges.splats.page import write_page
from irsim.bridges.splats.reading import read_splats
from irsim.cli.app import app
from irsim.common.files import TargetError
from irsim.runs.files import RunError
from tests.bridges.splats.conftest import Site


def content(page: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Head and arrays of a page."""
    match = re.search(r'id="data">([^<]*)<', page.read_text(encoding="utf-8"))
    assert match
    block = zlib.decompress(base64.b64decode(match[1]))
    (length,) = struct.unpack_from("<I", block)
    head = json.loads(block[4 : 4 + length])
    arrays = {
        item["name"]: np.frombuffer(block, f"<{item['kind']}", item["count"], item["begin"]) for item in head["columns"]
    }
    return head, arrays


def test_a_page_has_the_scene_in_the_frame_of_the_run(site: Site, tmp_path: Path) -> None:
    target = tmp_path / "room.html"
    result = write_page(site.scene, site.run, target)
    head, arrays = content(target)
    splats = read_splats(site.scene)
    assert (result.splats, result.of, result.bytes) == (len(splats), len(splats), target.stat().st_size)
    assert result.notes == []
    center = arrays["center"].reshape(-1, 3)
    np.testing.assert_allclose(center[:, 0], splats.center[:, 2], atol=1e-4)  # forward
    np.testing.assert_allclose(center[:, 2], 1.2 - splats.center[:, 1], atol=0.02)  # above the floor
    low, step = head["scales"]
    np.testing.assert_allclose(np.exp(low + step * arrays["scale"]), splats.scale.ravel(), rtol=0.03)
    np.testing.assert_allclose(arrays["color"].reshape(-1, 4)[:, 3] / 255, splats.opacity, atol=0.003)
    pose = arrays["pose"].reshape(head["rows"], len(head["objects"]), 3)
    assert [item["name"] for item in head["objects"]] == ["rover", "walker"]
    np.testing.assert_allclose(pose, site.run.trace().pose[:, :2], atol=1e-5)
    assert len(head["times"]) == head["rows"] == site.run.last_step + 1


def test_a_page_asks_for_nothing(site: Site, tmp_path: Path) -> None:
    write_page(site.scene, site.run, tmp_path / "room.html")
    text = (tmp_path / "room.html").read_text(encoding="utf-8")
    assert not re.search(r"https?://|import\s.*from|src=|{{", text)
    assert "default-src 'none'" in text


def test_a_page_keeps_what_is_seen_most(site: Site, tmp_path: Path) -> None:
    result = write_page(site.scene, site.run, tmp_path / "room.html", max_splats=1000)
    _, arrays = content(tmp_path / "room.html")
    assert result.splats == len(arrays["center"]) / 3 == 1000
    assert result.notes == [f"the page has 1,000 of {result.of:,} splats; --max-splats changes that"]
    assert arrays["color"].reshape(-1, 4)[:, 3].min() > 200  # no fog


def test_mistakes_leave_no_file(site: Site, tmp_path: Path) -> None:
    with pytest.raises(TargetError):
        write_page(site.scene, site.run, tmp_path / "a.png")
    with pytest.raises(RunError):
        write_page(site.scene, "none", tmp_path / "a.html", workspace=tmp_path)
    assert not list(tmp_path.iterdir())


def test_names_are_not_read_as_html(site: Site, tmp_path: Path) -> None:
    scene = tmp_path / "<script>alert(1)<.ply"
    scene.write_bytes(site.scene.read_bytes())
    write_page(scene, site.run, tmp_path / "a.html", max_splats=10)
    assert "<script>alert" not in (tmp_path / "a.html").read_text(encoding="utf-8")


def test_the_command(site: Site, tmp_path: Path) -> None:
    arguments = ["bridge", "page", str(site.scene), "--run", str(site.run.folder), "-o", str(tmp_path / "a.html")]
    done = CliRunner().invoke(app, [*arguments, "--max-splats", "50", "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.output)["splats"] == 50
