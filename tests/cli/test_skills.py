"""``irsim skills``: each host's folder, again and again, and never over changed files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from irsim.bundled import skills
from irsim.bundled.skills import PLACES, Skill, find_skills, install, place_of
from irsim.cli.app import app
from irsim.common import data_files as resources

NAMES = sorted(path.parent.name for path in resources.skills_directory().glob("*/SKILL.md"))


def call(*words: str) -> tuple[int, Any]:
    done = CliRunner().invoke(app, ["skills", *words, "--json"])
    return done.exit_code, json.loads(done.stdout)


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "project").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path / "project")


@pytest.fixture
def skill(tmp_path: Path) -> Callable[..., Skill]:
    """Makes versions of a small skill."""

    def make(version: str, **files: str) -> Skill:
        folder = tmp_path / f"source-{version}"
        folder.mkdir()
        (folder / "SKILL.md").write_text(f"---\nname: small\n---\n{version}\n", encoding="utf-8")
        for name, text in files.items():
            path = folder / name.replace("__", "/")
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return Skill("small", "", version, folder)

    return make


def test_list_names_every_skill_with_its_description() -> None:
    code, rows = call("list")
    assert code == 0
    assert [row["name"] for row in rows] == NAMES
    assert all(row["description"] and row["version"] and Path(row["folder"]).is_dir() for row in rows)
    shown = CliRunner().invoke(app, ["skills", "list"])
    assert all(name in shown.stdout for name in NAMES)


@pytest.mark.parametrize("where", ["--project", "--user"])
@pytest.mark.parametrize("target", PLACES)
def test_installed_where_the_host_looks_whole_and_once(target: str, where: str, tmp_path: Path) -> None:
    code, told = call("install", "--target", target, where)
    place = tmp_path / ("home" if where == "--user" else "project") / PLACES[target]
    assert code == 0
    assert {row["action"] for row in told["skills"]} == {"installed"}
    for skill in find_skills():
        for name, content in skill.files().items():
            assert (place / skill.name / name).read_bytes() == content
    before = {path: path.stat().st_mtime_ns for path in place.rglob("*")}
    code, told = call("install", "--target", target, where)
    assert code == 0
    assert {row["action"] for row in told["skills"]} == {"unchanged"}
    assert {path: path.stat().st_mtime_ns for path in place.rglob("*")} == before


def test_two_hosts_that_share_a_folder_get_it_once() -> None:
    _, told = call("install", "--target", "codex", "--target", "agents", "--target", "claude")
    assert [Path(row["folder"]).parts[-3] for row in told["skills"][:: len(NAMES)]] == [".agents", ".claude"]


def test_one_skill_and_a_dry_run(tmp_path: Path) -> None:
    code, told = call("install", "--target", "claude", "--skill", NAMES[0], "--dry-run")
    assert code == 0
    assert told["dry_run"] is True
    assert [(row["skill"], row["action"]) for row in told["skills"]] == [(NAMES[0], "installed")]
    assert list((tmp_path / "project").iterdir()) == []


def test_an_unknown_skill_is_refused_with_the_nearest_name() -> None:
    done = CliRunner().invoke(app, ["skills", "install", "--target", "claude", "--skill", "irsim-scenaro"])
    assert done.exit_code == 2
    assert "did you mean irsim-scenario?" in done.stderr


def test_what_the_user_changed_stays_until_forced() -> None:
    call("install", "--target", "claude")
    page = Path(".claude/skills/irsim-scenario/SKILL.md")
    page.write_text("mine", encoding="utf-8")
    code, told = call("install", "--target", "claude")
    assert code == 1
    rows = {row["skill"]: row for row in told["skills"]}
    assert rows["irsim-scenario"]["action"] == "kept"
    assert rows["irsim-scenario"]["changed"] == ["SKILL.md"]
    assert page.read_text(encoding="utf-8") == "mine"
    shown = CliRunner().invoke(app, ["skills", "install", "--target", "claude"])
    assert "kept; --force overwrites" in shown.stdout
    code, _ = call("install", "--target", "claude", "--force")
    assert code == 0
    assert page.read_text(encoding="utf-8") != "mine"


def test_an_update_replaces_what_is_ours_and_keeps_what_is_not(skill: Callable[..., Skill], tmp_path: Path) -> None:
    place = tmp_path / "place"
    install(place, [skill("1", old="old", scripts__run="1")])
    (place / "small" / "notes").write_text("mine", encoding="utf-8")
    (place / "small" / "notes").chmod(0o755)
    [done] = install(place, [skill("2", scripts__run="2", scripts__new="new")])
    assert (done.action, done.changed) == ("updated", [])
    assert done.written == ["SKILL.md", "old", "scripts/new", "scripts/run"]
    files = {path.name: path.read_text(encoding="utf-8") for path in (place / "small").rglob("*") if path.is_file()}
    assert not {"old"} & set(files)
    assert (files["run"], files["new"], files["notes"]) == ("2", "new", "mine")
    assert (place / "small" / "notes").stat().st_mode & 0o777 == 0o755
    assert [path.name for path in place.iterdir()] == ["small"]


def test_a_change_of_the_user_outlives_an_update_of_another_file(skill: Callable[..., Skill], tmp_path: Path) -> None:
    place = tmp_path / "place"
    install(place, [skill("1", run="1")])
    (place / "small" / "run").write_text("mine", encoding="utf-8")
    [done] = install(place, [skill("2", run="1")])
    assert (done.action, done.changed) == ("kept", ["run"])
    assert (place / "small" / "SKILL.md").read_text(encoding="utf-8").endswith("1\n")


def test_a_copy_made_by_hand_counts_as_changed_unless_it_is_equal(skill: Callable[..., Skill], tmp_path: Path) -> None:
    folder = tmp_path / "place" / "small"
    folder.mkdir(parents=True)
    one = skill("1")
    (folder / "SKILL.md").write_bytes((one.folder / "SKILL.md").read_bytes())
    assert install(folder.parent, [one])[0].action == "unchanged"
    assert install(folder.parent, [skill("2")])[0].action == "kept"


def test_a_link_is_left_alone_and_its_target_in_any_case(skill: Callable[..., Skill], tmp_path: Path) -> None:
    place, other = tmp_path / "place", tmp_path / "other"
    place.mkdir()
    other.mkdir()
    (place / "small").symlink_to(other)
    one = skill("1")
    assert install(place, [one])[0].action == "kept"
    assert install(place, [one], force=True)[0].action == "updated"
    assert not (place / "small").is_symlink()
    assert list(other.iterdir()) == []


@pytest.mark.parametrize("where", [".claude", ".claude/skills"])
@pytest.mark.parametrize("more", [[], ["--dry-run"], ["--force"]])
def test_a_link_to_nothing_in_place_of_the_folder_is_named(where: str, more: list[str]) -> None:
    link = Path(where)
    link.parent.mkdir(exist_ok=True)
    link.symlink_to("nowhere")
    result = CliRunner().invoke(app, ["skills", "install", "--target", "claude", *more])
    told = " ".join(result.stderr.split())
    assert result.exit_code == 1
    assert "error file-access" in told
    assert f"{where}' is a link to 'nowhere', which is not a folder." in told
    assert "Fix: create that folder, or remove the link: rm" in told
    link.unlink()
    link.write_text("", encoding="utf-8")
    result = CliRunner().invoke(app, ["skills", "install", "--target", "claude", *more])
    assert f"{where}' is a file where a folder must be" in " ".join(result.stderr.split())


def test_a_failure_leaves_what_was_there(
    skill: Callable[..., Skill], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "place"
    install(place, [skill("1", run="1")])
    real = skills.os.rename

    def fail(source: Path, target: Path) -> None:
        if Path(source).name == "new":
            raise OSError("no")
        real(source, target)

    monkeypatch.setattr(skills.os, "rename", fail)
    with pytest.raises(OSError, match="no"):
        install(place, [skill("2", run="2")])
    assert (place / "small" / "run").read_text(encoding="utf-8") == "1"
    assert [path.name for path in place.iterdir()] == ["small"]


def test_places_follow_the_home_directory(tmp_path: Path) -> None:
    assert place_of("claude", user=True) == tmp_path / "home" / ".claude" / "skills"
    assert place_of("cursor", project=tmp_path) == tmp_path / ".cursor" / "skills"
