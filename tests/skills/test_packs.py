"""Every skill follows the rules of its format, its links lead somewhere, its scripts explain themselves."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

import irsim
from irsim.lookup.reference import SKILLS
from tests.skills.conftest import ROOT, execute, parts, script

if sys.version_info >= (3, 11):
    import skills_ref
    import tomllib
else:
    import tomli as tomllib

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
FOLDER = ROOT / "skills"
FOLDERS = sorted(path.parent for path in (ROOT / "skills").glob("*/SKILL.md"))
EXAMPLES = [folder for skill in FOLDERS for folder in sorted(skill.glob("examples/*"))]
SCRIPTS = [path for skill in FOLDERS for path in sorted(skill.rglob("*.py")) if path.parent.name == "scripts"]
each = pytest.mark.parametrize("skill", FOLDERS, ids=lambda path: path.name)
example = pytest.mark.parametrize("folder", EXAMPLES, ids=lambda path: f"{path.parents[1].name}-{path.name}")


def test_the_four_packs_are_there() -> None:
    assert [skill.name for skill in FOLDERS] == ["irsim-benchmark", "irsim-dev", "irsim-runner", "irsim-scenario"]
    assert set(SKILLS) == {skill.name for skill in FOLDERS}


@each
def test_frontmatter_follows_the_specification(skill: Path) -> None:
    """The facts that agentskills' validator looks at, and quick_validate of anthropics/skills."""
    text = (skill / "SKILL.md").read_text(encoding="utf-8")
    assert text.startswith("---\n")
    front, _ = parts(skill / "SKILL.md")
    assert set(front) <= {"name", "description", "license", "compatibility", "metadata", "allowed-tools"}
    assert front["name"] == skill.name
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", front["name"])
    assert len(front["name"]) <= 64
    assert isinstance(front["description"], str)
    assert front["description"] == front["description"].strip()
    assert 0 < len(front["description"]) <= 1024
    assert not set("<>") & set(front["description"])
    assert isinstance(front["compatibility"], str)
    assert "Use it" in front["description"]
    assert re.search(r"\bNot for\b", front["description"])
    assert len(front["compatibility"]) <= 500
    assert all(isinstance(value, str) for value in front["metadata"].values())
    assert front["metadata"]["version"] == irsim.__version__


if sys.version_info >= (3, 11):  # which the validator needs; the test above has its rules

    @each
    def test_the_reference_validator_agrees(skill: Path) -> None:
        assert skills_ref.validate(skill) == []


@each
def test_short_enough_to_be_loaded_whole(skill: Path) -> None:
    text = (skill / "SKILL.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) < 300
    assert len(text) / 4 < 5000  # about four characters to a token


USUAL = {
    "a scenario that is written and run": (
        "irsim-scenario",
        ("guides/commands.md", "guides/loop.md", "guides/decide.md"),
    ),
    "a program around a scenario": ("irsim-runner", ("guides/output.md",)),
}
"""A usual task -> its skill, and the pages that it sends to on the way."""
MOST_READ = 25_000


def test_what_one_reads_for_a_usual_task_is_short() -> None:
    """Also for a request that needs both: a scenario, and a program that runs it."""
    read = {
        what: {FOLDER / name / "SKILL.md", *(FOLDER / name / page for page in pages)}
        for what, (name, pages) in USUAL.items()
    }
    for name, pages in USUAL.values():
        body = (FOLDER / name / "SKILL.md").read_text(encoding="utf-8")
        assert all(f"({page})" in body for page in pages)
    read["both"] = {FOLDER / name / "SKILL.md" for name in ("irsim-scenario", "irsim-runner")}
    read["both"] |= {FOLDER / "irsim-scenario" / page for page in ("guides/commands.md", "guides/loop.md")}
    sizes = {what: sum(len(page.read_bytes()) for page in pages) for what, pages in read.items()}
    assert {what: size for what, size in sizes.items() if size > MOST_READ} == {}


@each
def test_links_lead_to_files_of_the_skill_and_every_page_can_be_reached(skill: Path) -> None:
    pages = sorted(skill.rglob("*.md"))
    for page in pages:
        for link in re.findall(r"\[[^]]+\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
            target = (page.parent / link).resolve()
            assert target.is_file(), f"{page.name}: {link}"
            assert target.is_relative_to(skill)
    linked = {(skill / link).resolve() for link in re.findall(r"\]\(([^)#]+)\)", parts(skill / "SKILL.md")[1])}
    linked |= {page for target_page in linked for page in target_page.parent.glob("*.md")}
    assert set(pages) - linked == {skill / "SKILL.md"}


@each
def test_references_lie_one_level_deep_and_are_small(skill: Path) -> None:
    folder = skill / "references"
    assert all(path.is_file() for path in folder.iterdir())
    assert {path.name: len(path.read_bytes()) for path in folder.iterdir() if len(path.read_bytes()) > 20_000} == {}


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_scripts_explain_themselves_and_refuse_nonsense(path: Path, tmp_path: Path) -> None:
    told = execute(["python", str(path), "--help"], tmp_path)
    assert told.startswith("usage: ")
    assert len(told) < 4000
    code, refused = script(path, "missing-file", folder=tmp_path)
    assert (code, list(refused)) == (2, ["said"])
    assert "missing-file" in refused["said"]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_scripts_name_the_version_they_were_written_for(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    declared = re.search(r"\A#!.*\n# /// script\n((?:# .*\n)+)# ///\n", text)
    assert declared
    needs_irsim = bool(re.search(r"^(import|from) irsim\b", text, re.MULTILINE))
    assert tomllib.loads(re.sub("^# ", "", declared[1], flags=re.MULTILINE)) == {
        "requires-python": PROJECT["requires-python"],
        "dependencies": [f"{PROJECT['name']}=={PROJECT['version']}"] if needs_irsim else [],
    }
    assert "input(" not in text  # an agent cannot answer prompts


def test_each_pack_has_scripts_and_worked_examples() -> None:
    assert {path.parents[1].name for path in SCRIPTS} == {skill.name for skill in FOLDERS}
    for skill in FOLDERS:
        assert len([folder for folder in EXAMPLES if folder.is_relative_to(skill)]) >= 2, skill.name


@example
def test_an_example_leads_from_prompt_to_picture(folder: Path) -> None:
    names = {path.name for path in folder.iterdir()}
    assert {"prompt.md", "elements.md", "reply.md", "snapshot.png"} <= names
    assert {name for name in names if name.endswith(".yaml")}
    assert "| asked |" in (folder / "elements.md").read_text(encoding="utf-8")
    assert "emplate" in (folder / "elements.md").read_text(encoding="utf-8") or folder.name in ("patrol-edit", "cafe")


@example
def test_pictures_are_small(folder: Path) -> None:
    png = (folder / "snapshot.png").read_bytes()
    assert png.startswith(b"\x89PNG")
    assert max(int.from_bytes(png[16:20], "big"), int.from_bytes(png[20:24], "big")) <= 480
    assert len(png) < 20_000
