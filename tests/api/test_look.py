"""The look that a picture is asked for: what does not go together is refused before anything is drawn."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.api.render_run import render_run
from irsim.cli.app import app
from irsim.diagnostics.errors import InputError

SCENE = """
world: {{width: 4, height: 4, time_limit: 1, plot: {{style: {style}}}}}
robot: {{state: [1, 1, 0], goal: [3, 3, 0]}}
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "classic.yaml").write_text(SCENE.format(style="classic"))
    (tmp_path / "modern.yaml").write_text(SCENE.format(style="modern"))
    return tmp_path


@pytest.mark.parametrize(
    ("name", "asked", "said"),
    [
        ("classic", ["--print"], "classic does not have a layout for print"),
        ("classic", ["--theme", "dark"], "classic does not have themes"),
        ("modern", ["--style", "classic", "--print"], "classic does not have a layout for print"),
        ("modern", ["--print", "--strip", "3"], "a strip does not have a layout for print"),
        ("modern", ["--style", "modren"], "'modren' is not a style of pictures"),
        ("modern", ["--theme", "drak"], "'drak' is not a theme of pictures"),
    ],
)
def test_looks_that_do_not_exist_are_refused(scene: Path, name: str, asked: list[str], said: str) -> None:
    out = scene / "look.png"
    done = CliRunner().invoke(app, ["render", str(scene / f"{name}.yaml"), "-o", str(out), *asked])
    assert done.exit_code == 2
    assert said in " ".join(done.output.split())
    assert not out.exists()


def test_records_are_drawn_by_the_same_rules(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(scene)
    run = irsim.run("modern.yaml", seed=1, record=True).run_id
    assert run is not None
    with pytest.raises(InputError, match="a strip does not have a layout for print"):
        render_run(run, "look.png", strip=2, printed=True)
    render_run(run, "look.png", style="modern", theme="dark", printed=True)
    assert Path("look.png").stat().st_size
