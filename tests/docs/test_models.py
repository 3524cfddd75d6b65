"""Pages of models on the site: each has its text, a scenario that runs, and a measured value within its tolerance.

The long statistical tests of each model are in tests/core and tests/env; these tests check the numbers of the plots.
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from typing import Any

import pytest

import irsim

pytestmark = pytest.mark.one_python

SITE = Path(__file__).resolve().parents[2] / ".ci" / "site"
MODELS = sorted(path.stem for path in (SITE / "realism").glob("*.md"))
each = pytest.mark.parametrize("name", MODELS)


@pytest.fixture
def models(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module that makes the pages."""
    monkeypatch.syspath_prepend(str(SITE))
    return importlib.import_module("models")


@each
def test_the_simulator_agrees_with_the_law_on_the_page(models: Any, name: str) -> None:
    one = models.validation_of(name)
    assert one.passes, one.caption
    assert one.tolerance > 0
    assert one.measured != 0 or one.expected == 0
    assert one.points
    assert one.lines


@each
def test_the_example_of_a_page_runs(models: Any, name: str) -> None:
    text = models.example_of(name)
    assert [one.message for one in irsim.validate(text=text).findings if one.severity != "hint"] == []
    assert irsim.run(text=text, steps=20).steps > 0


@each
def test_a_page_says_what_it_is_with_equation_keys_and_source(models: Any, name: str) -> None:
    text = models.text_of(name)
    assert re.findall(r"^## (.*)$", text, re.MULTILINE) == ["Equation", "Validation", "Example", "Keys", "Source"]
    assert re.search(r"\((19|20)\d\d\)", text.partition("## Source")[2]), "the source has its year"
    assert models.summary_of(text)


def test_the_navigation_has_every_model(models: Any) -> None:
    assert sorted(name for names in models.GROUPS.values() for name in names) == MODELS


def test_a_plot_is_drawn_for_both_themes_and_again_the_same(models: Any, tmp_path: Path) -> None:
    plots = importlib.import_module("plots")
    one = models.validation_of("actuation")
    for folder in ("first", "second"):
        plots.draw(one, tmp_path / folder, "actuation")
    light, dark = (tmp_path / "first" / f"actuation-{theme}.svg" for theme in ("light", "dark"))
    assert light.read_bytes() != dark.read_bytes()
    for path in (light, dark):
        assert path.read_bytes() == (tmp_path / "second" / path.name).read_bytes()
