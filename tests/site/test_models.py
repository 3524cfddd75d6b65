"""Pages of the models of realism: their plots, their keys, and the ways that lead to them."""

from __future__ import annotations

import posixpath
from pathlib import Path

import pytest

from tests.site.pages import read_pages

pytestmark = [pytest.mark.site, pytest.mark.one_python]

OVERVIEW = "skills/irsim-benchmark/results/realism"


def _models() -> list[str]:
    from models import GROUPS

    return [name for names in GROUPS.values() for name in names]


def _targets(html: Path, page: str) -> set[str]:
    """Pages that a page links, from the root of the site."""
    links = read_pages(html)[f"{page}.html"].links
    return {posixpath.normpath(posixpath.join(posixpath.dirname(page), link.partition("#")[0])) for link in links}


def test_each_page_has_a_plot_for_light_and_dark_with_what_was_measured(html: Path) -> None:
    for name in _models():
        page = read_pages(html)[f"realism/{name}.html"]
        plots = [one["src"] or "" for one in page.pictures if "irsim-plot" in (one.get("class") or "")]
        assert [Path(one).name for one in plots] == [f"{name}-light.svg", f"{name}-dark.svg"]
        text = (html / "realism" / f"{name}.html").read_text(encoding="utf-8")
        assert ": measured " in text, name
        assert ", tolerance ±" in text, name


def test_the_overview_and_the_pages_of_components_lead_to_models(html: Path) -> None:
    pages = {f"realism/{name}.html" for name in _models()}
    assert pages - _targets(html, OVERVIEW) == set()
    assert pages - _targets(html, "realism/index") == set()
    for start, model in (("sensor/imu", "imu"), ("sensor/lidar2d", "sweep"), ("kinematics/tricycle", "tricycle")):
        assert f"realism/{model}.html" in _targets(html, f"reference/{start}"), start


def test_every_page_has_the_part_in_its_bar(html: Path) -> None:
    assert "realism/index.html" in _targets(html, "index")
