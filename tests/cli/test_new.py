"""``irsim new`` and ``irsim templates``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml
from PIL import Image

from irsim.bundled import templates
from irsim.common import data_files as resources
from tests.cli.conftest import Run, parsed


def test_writes_a_file_that_runs(irsim: Run, tmp_path: Path) -> None:
    result = irsim("new", "corridor-passing", "--set", "width=2.4", code=0)
    data = yaml.safe_load((tmp_path / "corridor-passing.yaml").read_text(encoding="utf-8"))
    walls = [obstacle["state"][1] for obstacle in data["obstacle"]]
    assert walls[0] - walls[1] - 0.3 == pytest.approx(2.4)
    assert irsim("run", "corridor-passing.yaml", "--strict", "--require-success").exit_code == 0
    assert "irsim run corridor-passing.yaml" in result.stdout


def test_the_first_line_leads_editors_to_the_schema(irsim: Run, tmp_path: Path) -> None:
    irsim("new", "empty-room", "-o", "a b.yaml")
    first = (tmp_path / "a b.yaml").read_text(encoding="utf-8").splitlines()[0]
    assert first == f"# yaml-language-server: $schema={resources.published_schema()}"
    schema = json.loads(resources.schema_file().read_text(encoding="utf-8"))
    assert schema["$id"] == resources.published_schema()


def test_never_overwrites_unless_told_to(irsim: Run, tmp_path: Path) -> None:
    (tmp_path / "empty-room.yaml").write_text("mine", encoding="utf-8")
    refused = irsim("new", "empty-room", code=2)
    assert "--force" in refused.stderr
    assert (tmp_path / "empty-room.yaml").read_text(encoding="utf-8") == "mine"
    assert irsim("new", "empty-room", "--force").exit_code == 0
    assert "rover" in (tmp_path / "empty-room.yaml").read_text(encoding="utf-8")


def test_prints_to_standard_output(irsim: Run, tmp_path: Path) -> None:
    result = irsim("new", "empty-room", "-o", "-")
    assert yaml.safe_load(result.stdout)["robot"][0]["name"] == "rover"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "code", "help_text"),
    [
        (
            ["empty-rom"],
            "unknown-template",
            "there is no template 'empty-rom'. Fix: did you mean empty-room? irsim templates",
        ),
        (["empty-room", "--set", "widht=3"], "unknown-parameter", "width"),
        (["empty-room", "--set", "width=1"], "bad-parameter", "from 4 to 200 m"),
        (["empty-room", "--set", "width"], "bad-parameter", "KEY=VALUE"),
    ],
)
def test_mistakes_are_explained_and_nothing_is_written(
    irsim: Run, tmp_path: Path, words: list[str], code: str, help_text: str
) -> None:
    result = irsim("new", *words, code=2)
    assert code in result.stderr
    assert help_text in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_does_not_exist_is_made(irsim: Run, tmp_path: Path) -> None:
    irsim("new", "empty-room", "-o", str(tmp_path / "no" / "such" / "place.yaml"), code=0)
    assert (tmp_path / "no" / "such" / "place.yaml").exists()


def test_a_place_that_cannot_exist_is_a_failure(irsim: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    result = irsim("new", "empty-room", "-o", str(tmp_path / "file" / "place.yaml"), code=1)
    assert "file-access" in result.stderr


def test_templates_are_listed(irsim: Run) -> None:
    listed = irsim("templates").stdout
    data = parsed(irsim("templates", "--json"))
    assert len(data) >= 8
    for template in data:
        assert template["name"] in listed
        assert {"title", "purpose", "tags", "outcomes", "parameters"} <= set(template)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["hallway"], "corridor-passing"),
        (["pedestrian"], "crossing"),
        (["ackermann", "parking"], "car-park"),
        (["slam"], "lidar-explorer"),
        (["antipodal"], "circle-swap"),
        (["reinforcement learning"], "random-polygons"),
    ],
)
def test_templates_are_found_by_the_words_of_users(irsim: Run, words: list[str], expected: str) -> None:
    names = [template["name"] for template in json.loads(irsim("templates", "--json", *words).stdout)]
    assert expected in names
    assert len(names) <= len(templates.names()) // 4


def test_a_contact_sheet_of_templates(irsim: Run, tmp_path: Path) -> None:
    irsim("templates", "parking", "--sheet", str(tmp_path / "sheet.png"), code=0)
    with Image.open(tmp_path / "sheet.png") as sheet:
        assert sheet.width > 1000
        colors = sheet.convert("RGB").getcolors(1 << 20)
    assert colors is not None
    assert len(colors) > 100
