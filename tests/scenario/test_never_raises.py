"""Whatever one feeds to the reader, it answers with findings, never with an exception."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.diagnostics.report import format_diagnostics
from irsim.scenario.model.plot import ObjectPlot
from irsim.scenario.model.scenario import Entry, Scenario, WorldModel
from irsim.scenario.read import Reading, read
from tests.effort import examples

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
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.yaml"
        path.write_bytes(content)
        sound(read(path))
