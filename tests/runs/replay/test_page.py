from __future__ import annotations

import base64
import hashlib
import json
import re
from collections import Counter
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.common.files import TargetError
from irsim.common.pages import bundle
from irsim.graphics.scene import glyphs
from irsim.graphics.scene.sizes import NORMAL
from irsim.runs import Run, RunError, replay
from irsim.runs.replay.page import page
from tests.runs.replay.conftest import HOSTILE, recorded, scene
from tests.runs.replay.reading import data_in, unpacked

SOURCES = Path(replay.__file__).with_name("web")


def test_the_signs_of_the_page_are_those_of_pictures() -> None:
    text = page()
    table = json.loads(re.findall(r"--glyphs: '([^']*)'", text)[0])
    assert table["dart"] == [list(point) for point in glyphs.DART]
    assert table["sizes"]["star"] == NORMAL.star
    used = set(re.findall(r"GLYPHS\.(\w+)", bundle(SOURCES)))
    assert used <= set(table)
    code = (SOURCES / "glyphs.js").read_text(encoding="utf-8")
    for value in (glyphs.DART[0][0], glyphs.SMALLER[1], glyphs.NAME["halo"], glyphs.GOAL["dot"], glyphs.CROWD["few"]):
        assert not re.search(rf"\b{value}\b", code), "shapes and sizes are written once"


def test_modules_share_no_names() -> None:
    defined = re.findall(r"^(?:async )?(?:function|const|let|class) (\w+)", bundle(SOURCES), re.MULTILINE)
    for group in re.findall(r"^const (\w+ = [^;\n]*(?:, \w+ = [^;\n]*)+);", bundle(SOURCES), re.MULTILINE):
        defined += re.findall(r", (\w+) = ", group)
    assert [name for name, count in Counter(defined).items() if count > 1] == []


def test_every_module_is_in_the_page() -> None:
    text = bundle(SOURCES)
    assert not re.search(r"^(import|export)\b", text, re.MULTILINE)
    modules = sorted(SOURCES.glob("*.js"))
    assert len(modules) > 5
    for path in modules:
        assert path.read_text().splitlines()[0] in text, path.name


def test_the_policy_of_the_page_lists_the_hashes_of_what_it_holds() -> None:
    text = page(b"x")
    for kind, tag in (("style", "style"), ("script", "script")):
        inside = re.findall(rf"<{tag}>(.*?)</{tag}>", text, re.DOTALL)
        known = [base64.b64encode(hashlib.sha256(part.encode()).digest()).decode() for part in inside]
        assert re.findall(rf"{kind}-src 'sha256-(.*?)'", text) == known


@pytest.mark.parametrize("title", ["irsim run", "irsim replay"])
def test_a_page_has_one_title_until_its_run_is_there(title: str) -> None:
    text = page(title=title)
    assert f"<title>{title}</title>" in text
    assert f'<h1 id="title">{title}</h1>' in text


def test_the_empty_page() -> None:
    text = page()
    assert data_in(text) == b""
    assert len(text) < 200_000
    assert "default-src 'none'" in text
    assert "{{" not in text.replace("${{", "")


def test_nothing_in_the_page_names_another_place() -> None:
    assert re.findall(r"(?:https?:)?//[a-z0-9-]+\.[a-z]", page()) == []
    assert (
        re.findall(r"\b(?:fetch|XMLHttpRequest|WebSocket|eval|innerHTML|outerHTML|insertAdjacentHTML)\b", page()) == []
    )


def test_replay_writes_a_page(run: Run, workspace: Path) -> None:
    result = irsim.replay(run.id)
    text = Path(f"{run.id}.html").read_text()
    assert result.file == f"{run.id}.html"
    assert result.bytes == len(text.encode())
    assert (result.objects, result.last_step, result.every) == (6, run.last_step, 1)
    assert unpacked(data_in(text))[0]["run_id"] == run.id
    assert irsim.replay(run.folder, workspace / "other.html").run_id == run.id
    assert irsim.replay(run, "other.html").run_id == run.id


def test_names_stay_out_of_the_html(workspace: Path) -> None:
    (workspace / "x.yaml").write_text(scene(HOSTILE))
    irsim.run("x.yaml", steps=3, record=True)
    irsim.replay("last", "page.html")
    assert "hacked" not in Path("page.html").read_text()
    assert "&lt;script&gt;" in page(title="<script>")


def test_refusals(run: Run, workspace: Path) -> None:
    with pytest.raises(TargetError, match="unknown-format"):
        irsim.replay("last", "page.png")
    with pytest.raises(RunError, match="file-access"):
        irsim.replay("last", "nowhere/page.html")
    with pytest.raises(RunError, match="unknown-run"):
        irsim.replay("room-000000")


def test_the_command(run: Run, workspace: Path) -> None:
    done = CliRunner().invoke(app, ["replay", run.id, "-o", "page.html", "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout) == irsim.replay(run.id, "page.html").model_dump()
    shown = CliRunner().invoke(app, ["replay"])
    assert shown.stdout.startswith(f"wrote {run.id}.html (")


def test_a_run_that_was_cut_short_is_shown(workspace: Path) -> None:
    run = recorded(scene())
    (run.folder / "result.json").unlink()
    head = unpacked(data_in(Path(irsim.replay(run.id).file).read_text()))[0]
    assert head["outcome"] is None
    assert head["summary"] == "This run is interrupted."
