"""Names that leave the program are text wherever they go: no formula, HTML, link, code or mark of direction."""

from __future__ import annotations

import io
import json

import pytest

from irsim.cli.output import prepare_streams
from irsim.common.text import cell, escape_marks, markdown_code, markdown_text

EVIL = "<img src=x onerror=alert(1)> [a](http://evil) | `c` & \u202egnp.exe"


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1"])
def test_a_cell_is_no_formula(name: str) -> None:
    assert cell(name) == f"'{name}"


def test_other_cells_stay_as_they_are() -> None:
    assert [cell(name) for name in ("robot_0", "", "a=b", "'=1")] == ["robot_0", "", "a=b", "'=1"]


def test_markdown_shows_the_text_and_nothing_else() -> None:
    shown = markdown_text(EVIL)
    assert not set("<>|`\u202e") & set(shown)
    assert "](" not in shown


def test_code_in_markdown_does_not_end_early() -> None:
    assert markdown_code("irsim run a.yaml") == "`irsim run a.yaml`"
    assert markdown_code("a `b` ``c``") == "``` a `b` ``c`` ```"


def test_json_with_escaped_marks_has_the_same_value() -> None:
    text = json.dumps({"name": EVIL}, ensure_ascii=False)
    shown = escape_marks(text)
    assert "\u202e" not in shown
    assert json.loads(shown) == {"name": EVIL}


def test_no_command_prints_marks_of_direction(monkeypatch: pytest.MonkeyPatch) -> None:
    raw = io.BytesIO()
    stream = io.TextIOWrapper(raw, encoding="utf-8")
    monkeypatch.setattr("sys.stdout", stream)
    prepare_streams()
    print(EVIL, "gr\u00fcn")
    stream.flush()
    assert "\u202e".encode() not in raw.getvalue()
    assert b"\\u202egnp.exe gr\xc3\xbcn" in raw.getvalue()
