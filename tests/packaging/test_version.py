"""The version and the owner are in many files, are written by one command, and are the same everywhere."""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from irsim import __version__

pytestmark = pytest.mark.one_python

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / ".ci/release/places.py"


def load(path: Path) -> ModuleType:
    """The script, which is not part of the installed package."""
    spec = importlib.util.spec_from_file_location("irsim_places", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


places = load(SCRIPT)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The files with places, the changelog and the script, in a repository of their own."""
    names = {file for patterns in (places.VERSION_PLACES, places.OWNER_PLACES) for file in patterns}
    files = {path for name in names for path in ROOT.glob(name)}
    for path in (*files, ROOT / "CHANGELOG.md", SCRIPT):
        target = tmp_path / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
    for command in (["init", "-q"], ["add", "--all", "--force"]):
        subprocess.run(["git", *command], cwd=tmp_path, check=True)
    return tmp_path


def call(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(folder / SCRIPT.relative_to(ROOT)), *arguments]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False)


def test_all_places_hold_the_version_of_the_package() -> None:
    assert places.version() == __version__
    assert places.owner() == json.loads((ROOT / "server.json").read_text(encoding="utf-8"))["name"].split(".")[2][:-10]


def test_no_other_file_holds_the_version() -> None:
    assert places.unlisted() == []


def test_a_new_place_is_noticed(copy: Path) -> None:
    (copy / "extra.json").write_text(f'{{"name": "x", "version": "{__version__}"}}\n', encoding="utf-8")
    subprocess.run(["git", "add", "extra.json"], cwd=copy, check=True)
    assert [row.partition(":")[0] for row in places.unlisted(copy)] == ["extra.json"]


@pytest.mark.parametrize("new", ["10.20.30", "7.0.0rc2"])
def test_one_command_writes_every_place_and_nothing_else(copy: Path, new: str) -> None:
    before = {path: path.read_text(encoding="utf-8") for path in copy.rglob("*.*") if path.is_file()}
    done = call(copy, new, "--owner", "some-lab")
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"version={new}\nowner=some-lab\n"
    assert places.unlisted(copy) == []
    for path, old in before.items():
        text = path.read_text(encoding="utf-8")
        assert text.count("\n") == old.count("\n")
        if path != copy / "CHANGELOG.md":
            restored = text.replace(new, __version__).replace("some-lab", places.owner())
            assert restored == old, path
    assert json.loads((copy / "server.json").read_text(encoding="utf-8"))["name"] == "io.github.some-lab/irsim-mcp"
    assert (copy / ".github/CODEOWNERS").read_text(encoding="utf-8").endswith("* @some-lab\n")


@pytest.mark.parametrize("wrong", ["1.2", "v1.2.3", "1.2.3-rc1", "1.2.3.4", "latest"])
def test_other_forms_of_a_version_are_refused(copy: Path, wrong: str) -> None:
    done = call(copy, wrong)
    assert done.returncode == 1
    assert f"'{wrong}' is not of the form" in done.stderr
    assert places.version(copy) == __version__


def test_places_that_differ_are_listed(copy: Path) -> None:
    path = copy / "CITATION.cff"
    path.write_text(path.read_text(encoding="utf-8").replace(__version__, "9.9.9"), encoding="utf-8")
    done = call(copy, "--tag", f"v{__version__}")
    assert done.returncode == 1
    assert "  9.9.9  CITATION.cff" in done.stderr
    assert f"  {__version__}  pyproject.toml" in done.stderr


def test_a_tag_needs_the_version_and_a_section_of_the_changelog(copy: Path) -> None:
    (copy / "CHANGELOG.md").write_text("# Changelog\n\n## [Unreleased]\n\nNothing.\n", encoding="utf-8")
    assert "is not v2.0.0rc1" in call(copy, "2.0.0rc1", "--tag", "v2.0.0").stderr
    assert "no section '## [2.0.0] - DATE'" in call(copy, "--tag", "v2.0.0rc1").stderr
    text = "# Changelog\n\n## [2.0.0] - 2026-12-01\n\n- Faster.\n\n## [1.0.0] - 2026-11-01\n\n- First.\n"
    (copy / "CHANGELOG.md").write_text(text, encoding="utf-8")
    assert call(copy, "--tag", "v2.0.0rc1").returncode == 0
    assert call(copy, "--notes").stdout == "- Faster.\n"
