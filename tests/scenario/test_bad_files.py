"""Every file in ``tests/bad`` gives exactly the findings its header announces, and the schema refuses it too.

Header lines: ``# expect: <severity> <code> <path> <line>`` for each finding, and ``# schema accepts: <rule>`` where the
schema cannot tell, with the entry of ``INEXPRESSIBLE`` that says why. Features that are only not simulated yet,
and states left out, do not count, so that a file stays bad for its own reason.
"""

from __future__ import annotations

from pathlib import Path

import jsonschema
import pytest

from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.report import format_diagnostics
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.scenario.model.json_schema import INEXPRESSIBLE, json_schema
from irsim.scenario.read import read
from irsim.scenario.yaml.compose import compose

FILES = sorted((Path(__file__).parent.parent / "bad").glob("*.yaml"))
LATER = ("not-yet-simulated", "default-state")


def header(path: Path, word: str) -> list[str]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line.removeprefix(word) for line in lines if line.startswith(word)]


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(json_schema())


def test_there_are_many() -> None:
    assert len(FILES) >= 60


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_findings(path: Path) -> None:
    expected = header(path, "# expect: ")
    reading = read(path, strict=True)
    lines = [
        f"{item.severity} {item.code} {format_path(item.path)} {item.line}"
        for item in reading.diagnostics
        if item.code not in LATER or any(item.code in line for line in expected)
    ]
    assert lines == expected, f"if this is what should be found, write it into the header of {path}"
    assert (reading.scenario is None) == any(item.severity == "error" for item in reading.diagnostics)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_report_quotes_the_line(path: Path) -> None:
    reading = read(path, strict=True)
    text = path.read_text(encoding="utf-8")
    report = format_diagnostics(reading.diagnostics, text)
    lines = text.splitlines()
    for item in reading.diagnostics:
        assert item.line is not None
        assert item.column is not None
        assert 1 <= item.line <= len(lines)
        assert 1 <= item.column <= len(lines[item.line - 1]) + 1
        assert f"{path}:{item.line}:{item.column}  {item.severity} {item.code}" in report
        assert item.message in report
    assert "pydantic" not in report.lower()
    assert "https://" not in report


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_schema(path: Path, validator: jsonschema.Draft202012Validator) -> None:
    accepted = header(path, "# schema accepts: ")
    composed = compose(path.read_text(encoding="utf-8"), DEFAULT_LIMITS)
    if accepted:
        assert accepted[0] in INEXPRESSIBLE
        assert composed.data is None or validator.is_valid(composed.data)
    else:
        assert not validator.is_valid(composed.data)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_lenient_carries_on_only_where_nothing_else_is_wrong(path: Path) -> None:
    strict, lenient = read(path, strict=True), read(path)
    fatal = [item for item in strict.diagnostics if item.severity == "error" and not item.tolerated]
    assert (lenient.scenario is None) == bool(fatal)
    assert {(d.code, d.path) for d in lenient.diagnostics} == {(d.code, d.path) for d in strict.diagnostics}
