"""Names that leave the program are text wherever they go: no formula, HTML, link, code or mark of direction."""

from __future__ import annotations

import io
import json

import pytest
import yaml

from irsim.cli.output import prepare_streams
from irsim.common.text import cell, clean, decimal, escape_marks, markdown_code, markdown_text, plural

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


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(10.0, 4, "10"), (0.5, 4, "0.5"), (-0.00001, 4, "0"), (0.00001, 9, "0.00001"), (1e9, 6, "1000000000")],
)
def test_numbers_of_files_have_no_exponent_which_readers_of_yaml_take_for_text(
    value: float, digits: int, text: str
) -> None:
    assert decimal(value, digits) == text
    assert yaml.safe_load(decimal(value, digits)) == pytest.approx(value, abs=10**-digits)


def test_a_long_sentence_is_cut_between_words_and_a_name_anywhere() -> None:
    sentence = f"{'robot_0 went on, ' * 8}and it hit 'crate' at x 12.25 m"
    cut = [clean(sentence, longest) for longest in range(120, len(sentence) + 1)]
    assert cut[-1] == sentence
    for text in cut[:-1]:
        assert text.endswith(" ...")
        assert sentence.startswith(f"{text.removesuffix('...')}")
    assert clean("n" * 50, 40) == f"{'n' * 37}..."
    assert len(clean("n" * 500, 300)) == 300


def test_one_thing_is_singular() -> None:
    assert [plural(count, "wall") for count in (0, 1, 2)] == ["0 walls", "1 wall", "2 walls"]
