"""The workflows of GitHub: least rights, actions pinned to commits, and a dry run of a release that needs no secret."""

from __future__ import annotations

import os
import platform
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest
import yaml

pytestmark = pytest.mark.one_python

ROOT = Path(__file__).resolve().parents[2]
PATHS = sorted((ROOT / ".github/workflows").glob("*.yml"))
each = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)


def load(path: Path) -> dict[Any, Any]:
    """A workflow; YAML 1.1 reads the key ``on`` as a truth value."""
    workflow: dict[Any, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
    return workflow


RELEASE = load(ROOT / ".github/workflows/release.yml")["jobs"]


def published(name: str) -> bool:
    """Whether a job runs only where something is published: by its own condition, or because it needs such a job."""
    job = RELEASE[name]
    needs = [job["needs"]] if isinstance(job.get("needs"), str) else job.get("needs", [])
    return "needs.check-tag.outputs.publish == 'true'" in job.get("if", "") or any(map(published, needs))


@each
def test_jobs_have_the_rights_that_they_name_and_no_others(path: Path) -> None:
    workflow = load(path)
    assert workflow["permissions"] == {}
    assert [name for name, job in workflow["jobs"].items() if "permissions" not in job] == []


@each
def test_actions_are_pinned_to_commits(path: Path) -> None:
    uses = re.findall(r"uses: (.+)", path.read_text(encoding="utf-8"))
    assert [line for line in uses if not re.fullmatch(r"[\w/-]+@[0-9a-f]{40} # v\d+(\.\d+){1,2}", line)] == []


def test_one_action_has_one_version() -> None:
    texts = "".join(path.read_text(encoding="utf-8") for path in PATHS)
    pinned = dict.fromkeys(re.findall(r"uses: (\S+)", texts))
    assert len({line.partition("@")[0] for line in pinned}) == len(pinned)


def test_a_dry_run_has_no_step_that_needs_a_secret_or_an_account() -> None:
    dry = {name: job for name, job in RELEASE.items() if not published(name)}
    assert {"check-tag", "wheels", "sdist", "without-compiler", "clean", "assets"} == set(dry)
    for name, job in dry.items():
        assert set(job["permissions"].values()) <= {"read"}, name
        assert "environment" not in job
        assert not re.search(r"secrets\.|github\.token", str(job)), name


def test_the_version_reaches_pypi_before_the_registry_and_the_release() -> None:
    assert RELEASE["pypi"]["environment"] == "pypi"
    assert RELEASE["pypi"]["permissions"] == {"id-token": "write"}
    assert set(RELEASE["pypi"]["needs"]) >= {"check-tag", "clean", "without-compiler", "assets"}
    assert "candidate == 'false'" in RELEASE["pypi"]["if"]
    assert "candidate == 'true'" in RELEASE["testpypi"]["if"]
    assert "pypi" in RELEASE["github-release"]["needs"]
    assert "pypi" in RELEASE["wait"]["needs"]
    assert RELEASE["mcp-registry"]["needs"] == "wait"


@pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"), reason="the episode was recorded there"
)
def test_the_recorded_episode_is_the_one_that_this_core_plays(tmp_path: Path) -> None:
    golden = [sys.executable, str(ROOT / ".ci/release/golden.py")]
    scene = ROOT / "templates/crossing/scenario.yaml"
    done = subprocess.run([*golden, str(scene)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stderr}\nIf results changed on purpose: golden.py {scene} --write"
    other = tmp_path / "other.yaml"
    other.write_text(scene.read_text(encoding="utf-8").replace("vel_max: [1.2, 2.0]", "vel_max: [1.1, 2.0]"), "utf-8")
    done = subprocess.run([*golden, str(other)], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("golden episode: steps 1 to 10 differ on Linux x86_64, Python")


def test_schemas_and_templates_are_packed_the_same_each_time(tmp_path: Path) -> None:
    contents = []
    for name in ("one", "other"):
        folder = tmp_path / name
        folder.mkdir()
        command = [sys.executable, str(ROOT / ".ci/release/assets.py"), str(folder)]
        subprocess.run(command, check=True, capture_output=True, env={**os.environ, "SOURCE_DATE_EPOCH": "1790000000"})
        contents.append({path.name: path.read_bytes() for path in folder.iterdir()})
    assert contents[0] == contents[1]
    names = set()
    for path in (tmp_path / "one").iterdir():
        with zipfile.ZipFile(path) as archive:
            names |= set(archive.namelist())
    sources = [path for folder in ("schema", "templates") for path in (ROOT / folder).rglob("*.*")]
    assert names == {path.relative_to(ROOT).as_posix() for path in sources if path.is_file() and path.suffix != ".pyc"}
