"""Bad input gives findings, never an exception.

Every file in the folder ``bad`` beside this one gives exactly the findings that its header announces, and the schema
refuses it too: lines ``# expect: <severity> <code> <path> <line>`` for each finding, and ``# schema accepts: <rule>``
where the schema cannot tell, with the entry of ``INEXPRESSIBLE`` that says why. Features that are only not simulated
yet, and states left out, do not count, so that a file stays bad for its own reason. The example of each code gives that
code.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.common.yaml.compose import compose
from irsim.diagnostics.codes import CODES
from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.examples import EXAMPLES
from irsim.diagnostics.report import format_diagnostics
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.scenario.model.json_schema import INEXPRESSIBLE, json_schema
from irsim.scenario.model.plot import ObjectPlot
from irsim.scenario.model.scenario import Entry, Scenario, WorldModel
from irsim.scenario.read import Reading, read
from irsim.validation.feasibility.check import feasibility_findings
from tests.effort import examples

FILES = sorted(Path(__file__).with_name("bad").glob("*.yaml"))
LATER = ("not-yet-simulated", "default-state")


def header(path: Path, word: str) -> list[str]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line.removeprefix(word) for line in lines if line.startswith(word)]


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(json_schema())


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


ROBOT = {
    "kinematics": {"name": "diff"},
    "shape": {"name": "circle", "radius": 0.2},
    "behavior": {"name": "dash"},
    "state": [1, 1, 0],
    "goal": [9, 9],
}
OBSTACLE = {"shape": {"name": "circle", "radius": 0.3}, "state": [5, 8, 0]}
AS_TEXT = ("yaml-", "empty-", "multiple-", "not-a-scenario", "unsupported-", "duplicate-key", "hash-")


def codes(code: str, text: str) -> set[str]:
    if code.startswith(AS_TEXT):
        return {d.code for d in read(text + "\n", strict=True, feasibility=feasibility_findings).diagnostics}
    data: dict[str, Any] = yaml.safe_load(text)
    robot = data.get("robot", {})
    if robot is not None:
        whole = {**ROBOT, **robot}
        if "distribution" in robot or "waypoints" in robot:
            whole = {key: value for key, value in whole.items() if key in robot or key not in ("state", "goal")}
        data["robot"] = [whole]
    else:
        data["robot"] = []
    if "obstacle" in data:
        kept = {} if code in ("default-state", "missing-key") else OBSTACLE
        data["obstacle"] = [{**kept, **data["obstacle"]}]
    return {d.code for d in read(data, strict=True, feasibility=feasibility_findings).diagnostics}


@pytest.mark.parametrize("code", EXAMPLES)
def test_the_example_shows_it(code: str) -> None:
    wrong, right = EXAMPLES[code]
    assert code in CODES
    assert code in codes(code, wrong)
    assert code not in codes(code, right)


def test_what_can_be_shown_is_shown() -> None:
    files = ("file", "image", "unreadable", "not-text", "not-a-file", "path", "map", "no-map", "not-yet")
    sizes = ("too-", "recursive", "alias", "bad-key", "invalid-value")
    code_of_users = ("behavior-for-other-drive", "group-", "fog-")
    of_tasks = ("unknown-reward", "unknown-part", "bridges-not-opened")
    others = (*files, *sizes, *code_of_users, *of_tasks)
    left = [code for code in CODES if code not in EXAMPLES and not code.startswith(others)]
    assert left == [], "give each of these codes an example in irsim/diagnostics/examples.py"


KEYS = sorted(
    {*Scenario.model_fields, *Entry.model_fields, *WorldModel.model_fields, *list(ObjectPlot.model_fields)[:8]}
)
NAMES = [
    "diff",
    "acker",
    "circle",
    "polygon",
    "compound",
    "linestring",
    "random",
    "dash",
    "follow",
    "lidar2d",
    "perlin",
]
keys = st.sampled_from([*KEYS, "name", "radius", "vertices", "parts", "pose", "range_low", "planner"]) | st.text(
    max_size=3
)
scalars = (
    st.none()
    | st.booleans()
    | st.integers(-(2**70), 2**70)
    | st.floats()
    | st.sampled_from([*NAMES, "pi", "1e3", "on", "5 m", "#fff", "\x1b[2J"])
    | st.text(max_size=4)
)
trees = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(keys, inner, max_size=5)
        | st.dictionaries(st.integers() | st.booleans() | st.none(), inner, max_size=2)
    ),
    max_leaves=20,
)
entries = st.dictionaries(keys, trees, max_size=6)


def sound(reading: Reading) -> None:
    assert (reading.scenario is None) == bool(reading.errors)
    report = format_diagnostics(reading.diagnostics, reading.document.text)
    assert "\x1b" not in report
    assert len(reading.diagnostics) <= 101


@given(
    st.fixed_dictionaries({}, optional={"world": entries, "robot": entries | st.lists(entries, max_size=3)}),
    st.booleans(),
)
@settings(max_examples=examples(300))
def test_any_data(data: dict[str, Any], strict: bool) -> None:
    sound(read(data, strict=strict))


@given(trees)
@settings(max_examples=examples(100))
def test_any_document(data: Any) -> None:
    if not isinstance(data, str):
        sound(read(data))


@given(st.text() | st.text(alphabet="abc:-[]{}&*!|>'\"#,?\n\t 0123456789.%@`~"))
@settings(max_examples=examples(300))
def test_any_text(text: str) -> None:
    sound(read(text + "\n"))


@given(st.binary(max_size=200))
@settings(max_examples=examples(100))
def test_any_bytes(content: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.yaml"
        path.write_bytes(content)
        sound(read(path))
