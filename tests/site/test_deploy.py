"""Versions of the site lie side by side; addresses that are gone lead on."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.one_python

ROOT = Path(__file__).resolve().parents[2]
DEPLOY = ROOT / ".ci/site/deploy.py"


def make_site(folder: Path, version: str, *others: str) -> Path:
    for name in ("index.html", "reference/index.html", *others):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(f"<p>{name} of {version}</p>", encoding="utf-8")
    return folder


def deploy(html: Path, pages: Path, version: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(DEPLOY), str(html), str(pages), version, "--address", "https://example.org/irsim"]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture
def pages(tmp_path: Path) -> Path:
    """Three versions, the newest release not last."""
    pages = tmp_path / "pages"
    for version in ("v0.9.0", "v0.10.0", "dev"):
        done = deploy(make_site(tmp_path / version, version, "reference/old.html"), pages, version)
        assert done.returncode == 0, done.stderr
    return pages


def test_three_versions_lie_side_by_side(pages: Path) -> None:
    for version in ("v0.9.0", "v0.10.0", "dev"):
        assert f"of {version}<" in (pages / version / "index.html").read_text(encoding="utf-8")
    assert "of v0.10.0<" in (pages / "latest" / "index.html").read_text(encoding="utf-8")
    entries = json.loads((pages / "switcher.json").read_text(encoding="utf-8"))
    assert [entry["version"] for entry in entries] == ["v0.10.0", "v0.9.0", "dev"]
    assert [entry["version"] for entry in entries if entry.get("preferred")] == ["v0.10.0"]
    assert all((pages / entry["url"].removeprefix("https://example.org/irsim/")).is_dir() for entry in entries)
    assert "url=latest/index.html" in (pages / "index.html").read_text(encoding="utf-8")


def test_an_older_fix_does_not_become_the_latest(pages: Path, tmp_path: Path) -> None:
    deploy(make_site(tmp_path / "fix", "v0.9.1"), pages, "v0.9.1")
    assert "of v0.10.0<" in (pages / "latest" / "index.html").read_text(encoding="utf-8")


def test_a_page_that_is_gone_leads_on_for_ever(pages: Path, tmp_path: Path) -> None:
    for k in range(2):  # the second time the page was a stub before
        deploy(make_site(tmp_path / f"later{k}", "dev"), pages, "dev")
        stub = (pages / "dev" / "reference" / "old.html").read_text(encoding="utf-8")
        target = re.search(r'url=([^"]+)"', stub)
        assert target is not None
        assert (pages / "dev" / "reference" / target[1]).resolve() == (
            pages / "dev" / "reference" / "index.html"
        ).resolve()
    assert "of v0.9.0<" in (pages / "v0.9.0" / "reference" / "old.html").read_text(encoding="utf-8")


def test_a_version_without_a_meaning_is_refused(pages: Path, tmp_path: Path) -> None:
    done = deploy(make_site(tmp_path / "x", "x"), pages, "main; rm")
    assert done.returncode == 1
    assert "neither dev nor the tag of a release" in done.stderr


def test_the_workflow_builds_what_it_deploys() -> None:
    workflow = (ROOT / ".github/workflows/site.yml").read_text(encoding="utf-8")
    assert "nox -s docs" in workflow
    assert ".ci/site/deploy.py site/html" in workflow
    assert 'Path("site")' in (ROOT / "noxfile.py").read_text(encoding="utf-8")
