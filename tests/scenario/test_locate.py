"""Where a scenario file is looked for, and what is said when it is nowhere."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from irsim.diagnostics.errors import ScenarioNotFoundError
from irsim.scenario.locate import default_name, locate


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Path]:
    """The current directory, the first entry of the import path, and the folder of the script."""
    folders = {name: tmp_path / name for name in ("here", "first", "script")}
    for folder in folders.values():
        folder.mkdir()
    monkeypatch.chdir(folders["here"])
    monkeypatch.setattr(sys, "path", [str(folders["first"]), *sys.path])
    monkeypatch.setattr(sys, "argv", [str(folders["script"] / "my_run.v2.py")])
    return folders


def test_order(places: dict[str, Path]) -> None:
    for name in ("script", "first", "here"):
        (places[name] / "a.yaml").write_text("", encoding="utf-8")
        path = Path(locate("a.yaml")).resolve()
        assert path == (places[name] / "a.yaml").resolve()


def test_absolute_and_below(places: dict[str, Path]) -> None:
    folder = places["script"] / "worlds"
    folder.mkdir()
    file = folder / "b.yaml"
    file.write_text("", encoding="utf-8")
    assert locate(file) == str(file)
    assert Path(locate("worlds/b.yaml")) == file


def test_named_like_the_script(places: dict[str, Path]) -> None:
    assert default_name() == "my_run.yaml"
    file = places["script"] / "my_run.yaml"
    file.write_text("", encoding="utf-8")
    assert Path(locate()) == file


def test_not_found_says_where_and_what_is_near(places: dict[str, Path]) -> None:
    (places["first"] / "crossing.yaml").write_text("", encoding="utf-8")
    with pytest.raises(ScenarioNotFoundError) as caught:
        locate("crosing.yaml")
    message = str(caught.value)
    for folder in places.values():
        assert str(folder) in message
    assert "Did you mean" in message
    assert "crossing.yaml" in message
    assert isinstance(caught.value, FileNotFoundError)
    with pytest.raises(ScenarioNotFoundError) as caught:
        locate("entirely-different.yaml")
    assert "Did you mean" not in str(caught.value)


def test_a_forgotten_extension_is_a_near_match(places: dict[str, Path]) -> None:
    (places["here"] / "crossing.yaml").write_text("", encoding="utf-8")
    with pytest.raises(ScenarioNotFoundError, match=r"crossing\.yaml"):
        locate("crossing")


def test_a_directory_is_left_to_the_reader(places: dict[str, Path]) -> None:
    assert locate(places["here"]) == str(places["here"])


@pytest.mark.parametrize("wanted", ["doorway", "doorway.yaml", "templates/doorway", "templates/doorway/scenario.yaml"])
def test_the_name_of_a_template_says_how_to_make_a_file_of_it(places: dict[str, Path], wanted: str) -> None:
    with pytest.raises(ScenarioNotFoundError) as caught:
        locate(wanted)
    last = str(caught.value).splitlines()[-1]
    assert last == "'doorway' is a template: `irsim new doorway` writes doorway.yaml, which can then be used."
    with pytest.raises(ScenarioNotFoundError) as caught:
        locate("doorways")
    assert "irsim new" not in str(caught.value)
