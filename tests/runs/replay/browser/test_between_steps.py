"""Contacts within a step on the page: a row, a mark at the place, and the moment within the step."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from tests.api.test_between_steps import scene as tunnel
from tests.browser import Watched
from tests.runs.replay.browser.test_player import SHARE, pixel_of, settled, value
from tests.runs.replay.conftest import recorded

pytestmark = pytest.mark.browser


def test_contacts_between_steps_are_marked_where_and_when_they_happen(workspace: Path, watched: Watched) -> None:
    """A row in the list, which leads to the moment within the step; a red mark at the place and on the time line."""
    run = recorded(tunnel())
    page = watched.open(Path(irsim.replay(run).file))
    assert page.inner_text("#facts").startswith("'runner' passed through 'board' between two steps at 2.31 s")
    rows = page.locator("#events button")
    assert [text.split("\n") for text in rows.all_inner_texts()] == [
        ["1.32 s", "runner touches post between two steps"],
        ["2.31 s", "runner passes through board between two steps"],
        ["3.30 s", "runner arrives"],
    ]
    rows.nth(1).click()
    settled(page)
    assert rows.nth(1).get_attribute("aria-current") == "true"
    assert value(page, "position") == "7.94, 3.00 m"  # where it touches the board, between 7.9 and 8.2
    x, y = pixel_of(page, 8.04, 3, world=(12, 6))
    red, green, blue = page.evaluate(SHARE, [x - 8, y - 9, 16, 18])
    assert red > 1.1 * max(green, blue)
    page.keyboard.press("]")
    settled(page)
    assert rows.nth(2).get_attribute("aria-current") == "true"
    page.keyboard.press("[")
    page.keyboard.press("[")
    settled(page)
    assert rows.nth(0).get_attribute("aria-current") == "true"
