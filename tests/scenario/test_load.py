"""Reading files: where they are looked for, what values become, where things stand, and what is refused."""

from __future__ import annotations

import datetime
import math
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.common.yaml import compose as compose_module
from irsim.common.yaml.compose import compose
from irsim.common.yaml.nodes import Mark
from irsim.diagnostics.errors import ScenarioNotFoundError
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.locate import default_name, locate
from irsim.scenario.yaml.document import load_data, load_path, load_text
from tests.effort import examples

SCALARS = [
    "1", "-1", "+3", "0", "1_000", "0x1F", "0b101", "1.5", "-.5", "1.", "1.0e+3", "1.5e-3", "1e3", "1.0e3", ".inf",
    "-.inf", "+.INF", "true", "False", "YES", "no", "on", "Off", "null", "~", "Null", "y", "n", "abc", "'1'", '"x"',
    "2024-01-31", "12:30:45", "1:30.5", "010", "08", "0o10", "-010", "1-2", ".", "1.2.3", "!!str 5",
    "!!float 3", "!!int '7'", "!!bool yes", "!!null ''", "! 5", "_1", "1__0.5", "0.1_5",
]  # fmt: skip


@pytest.mark.parametrize("text", SCALARS)
def test_scalars_are_those_of_the_safe_loader(text: str) -> None:
    wanted = yaml.safe_load(f"a: {text}")
    composed = compose(f"a: {text}", DEFAULT_LIMITS)
    assert composed.data == wanted
    assert type(composed.data["a"]) is type(wanted["a"])


def test_nan_and_dates() -> None:
    data = load_text("a: .nan\nb: 2024-01-31\nc: 2024-01-31 10:11:12\nd: 2024-99-99\n").data
    assert math.isnan(data.pop("a"))
    moment = datetime.datetime(2024, 1, 31, 10, 11, 12)
    assert data == {"b": moment.date(), "c": moment, "d": "2024-99-99"}


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers(-(10**12), 10**12) | st.floats(allow_nan=False) | st.text(max_size=12),
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
        max_leaves=25,
    ),
    st.booleans(),
)
@settings(max_examples=examples(150))
def test_data_is_that_of_the_safe_loader(data: Any, block: bool) -> None:
    text = yaml.safe_dump({"custom": data}, default_flow_style=not block, allow_unicode=True)
    composed = compose(text, DEFAULT_LIMITS)
    assert not composed.fatal
    assert composed.data == yaml.safe_load(text)


def test_aliases_and_merge_keys_as_the_safe_loader_has_them() -> None:
    text = (
        "custom:\n  base: &b {x: 1, y: 2}\n  more: &m {y: 3, z: 4}\n  one: {<<: *b, y: 9}\n"
        "  two: {<<: [*b, *m], w: 0}\n  same: *b\n"
    )
    assert compose(text, DEFAULT_LIMITS).data == yaml.safe_load(text)


def test_of_two_merge_keys_the_last_one_wins() -> None:
    # PyYAML lets the first one win since version 6.0.4.
    text = "custom:\n  base: &b {x: 1, y: 2}\n  more: &m {y: 3, z: 4}\n  three: {w: 0, <<: *m, <<: *b}\n"
    assert compose(text, DEFAULT_LIMITS).data["custom"]["three"] == {"w": 0, "x": 1, "y": 2, "z": 4}


def test_without_libyaml(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "world: &w {height: 1.5, tags: [a, 'b']}\ncustom: *w\n"
    expected = compose(text, DEFAULT_LIMITS, positions=True)
    monkeypatch.setattr(compose_module.yaml, "__with_libyaml__", False)
    document = compose(text, DEFAULT_LIMITS, positions=True)
    assert document.data == expected.data
    assert document.root == expected.root
    assert compose("a: [1", DEFAULT_LIMITS).problems[0].code == "yaml-syntax"


@pytest.mark.parametrize(
    ("path", "value", "key"),
    [
        ((), Mark(1, 1, 1), Mark(1, 1, 1)),
        (("world",), Mark(1, 8, 12), Mark(1, 1, 5)),
        (("robot",), Mark(3, 3, 1), Mark(2, 1, 5)),
        (("robot", 0), Mark(3, 5, 1), Mark(3, 5, 1)),
        (("robot", 0, "behavior", "name"), Mark(4, 22, 6), Mark(4, 16, 4)),
        (("robot", 0, "behavior", "missing"), Mark(4, 5, 8), Mark(4, 5, 8)),
        (("robot", 1, "shape", "radius"), Mark(7, 15, 3), Mark(7, 7, 6)),
        (("robot", 1, "state", 1), Mark(8, 16, 2), Mark(8, 16, 2)),
        (("robot", 7), Mark(2, 1, 5), Mark(2, 1, 5)),
    ],
)
def test_positions(path: tuple[str | int, ...], value: Mark, key: Mark) -> None:
    text = (
        "world: {height: 10}\n"
        "robot:\n"
        "  - kinematics: {name: diff}\n"
        "    behavior: {name: 'dash'}\n"
        "  - kinematics:\n"
        "    shape:\n"
        "      radius: 0.5\n"
        "    state: [1, -2]\n"
    )
    document = load_text(text)
    assert document.mark(path) == value
    assert document.mark(path, key=True) == key


def test_positions_follow_aliases_and_merges() -> None:
    document = load_text("custom: &c {radius: -1}\nobstacle:\n  shape: {<<: *c, name: circle}\n  plot: *c\n")
    assert document.mark(("obstacle", "shape", "radius")) == Mark(1, 21, 2)
    assert document.mark(("obstacle", "shape", "radius"), key=True) == Mark(1, 13, 6)
    assert document.mark(("obstacle", "plot", "radius")) == Mark(1, 21, 2)


def test_source_text() -> None:
    document = load_text("world: {step_time: 1e-1, name: 'on'}\n")
    assert document.source_text(("world", "step_time")) == "1e-1"
    assert document.source_text(("world", "name")) == "'on'"
    assert load_data({"world": {}}).source_text(("world",)) is None


def test_wrapper_of_a_shared_file() -> None:
    document = load_text("other: 1\nirsim: {world: {height: 3}}\n")
    assert (document.data, document.prefix) == ({"world": {"height": 3}}, ("irsim",))
    assert load_text("irsim: 3\n").data == {"irsim": 3}


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("", "empty-document", 1),
        ("# nothing\n\n", "empty-document", 1),
        ("a: [1, 2\nb: 3\n", "yaml-syntax", 2),
        ("a: 'open\n", "yaml-syntax", 2),
        ("a:\n\tb: 1\n", "yaml-syntax", 2),
        ("a: *nothing\n", "yaml-syntax", 1),
        ("a: &x [*x]\n", "recursive-alias", 1),
        ("a: 1\n---\nb: 2\n", "multiple-documents", 2),
        ("a: !!python/name:os.system x\n", "unsupported-tag", 1),
        ("a: !mine {b: 1}\n", "unsupported-tag", 1),
        ("a: !!int x\n", "unsupported-tag", 1),
        ("a: {[1]: 2}\n", "bad-key", 1),
        ("a: {<<: 3}\n", "bad-key", 1),
        ("%YAML 9.9\n---\na: 1\n", "yaml-syntax", 1),
    ],
)
def test_refused(text: str, code: str, line: int) -> None:
    document = load_text(text)
    assert document.fatal
    assert [problem.code for problem in document.problems] == [code]
    assert document.problems[0].line in (line, line + 1, None)
    assert "\t" not in text or "tab" in document.problems[0].message


def test_duplicate_keys_keep_the_last_value() -> None:
    document = load_text("world:\n  height: 1\n  width: 2\n  height: 3\n")
    assert document.data == {"world": {"height": 3, "width": 2}}
    (problem,) = document.problems
    assert (problem.code, problem.path) == ("duplicate-key", ("world", "height"))
    assert (problem.line, problem.column, problem.tolerated) == (4, 3, True)


def test_missing_directory_device_binary(tmp_path: Path) -> None:
    def code(path: Path | str) -> str:
        (problem,) = load_path(path).problems
        return problem.code

    binary, latin, zeros = b"\x89PNG\r\n\x1a\n\x00\x00", "name: caf\u00e9".encode("latin-1"), b"world: 1\n\x00\x01"
    for content in (binary, latin, zeros):
        (tmp_path / "a.yaml").write_bytes(content)
        assert code(tmp_path / "a.yaml") == "not-text"
    assert [code(path) for path in (tmp_path / "none.yaml", tmp_path)] == ["file-not-found", "not-a-file"]
    assert code("bad\0name") == "unreadable"


def test_byte_order_mark_and_line_ends(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_bytes(b"\xef\xbb\xbfworld: {height: 3}\r\nrobot: null\r\n")
    assert load_path(path).data == {"world": {"height": 3}, "robot": None}


def test_limits() -> None:
    tight = Limits(bytes=100, events=20, expansion=10, depth=3)
    assert load_text("a" * 101, limits=tight).problems[0].code == "file-too-large"
    assert load_text("[1,2,3,4,5,6,7,8,9,1,2,3,4,5,6,7,8]", limits=tight).problems[0].code == "too-many-events"
    assert load_text("{a: 1, b: {c: 1}, d: 1, e: 1}", limits=Limits(keys=3)).problems[0].code == "too-many-events"
    assert not load_text("{a: 1, b: {c: 1}, d: 1}", limits=Limits(keys=3)).problems
    assert load_text("[[[[1]]]]", limits=tight).problems[0].code == "too-deep"
    assert load_text("a: &a [1, 2, 3, 4]\nb: [*a, *a, *a]\n", limits=tight).problems[0].code == "alias-expansion"
    assert load_text("a: &a [[1]]\nb: [*a]\n", limits=tight).problems[0].code == "too-deep"
    assert not load_text("a: &a [[1]]\nb: *a\n", limits=tight).fatal


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Path]:
    """The current directory, the first entry of the import path, and the folder of the script."""
    folders = {name: tmp_path / name for name in ("here", "first", "script")}
    for folder in folders.values():
        folder.mkdir()
    monkeypatch.chdir(folders["here"])
    monkeypatch.setattr(sys, "path", [str(folders["first"]), *sys.path])
    monkeypatch.setattr(sys, "argv", [str(folders["script"] / "my_run.v2.py")])
    return folders


def written(file: Path) -> Path:
    file.parent.mkdir(exist_ok=True)
    file.write_text("", encoding="utf-8")
    return file


def test_order(places: dict[str, Path]) -> None:
    for name in ("script", "first", "here"):
        file = written(places[name] / "a.yaml")
        assert Path(locate("a.yaml")).resolve() == file.resolve()


def test_absolute_and_below(places: dict[str, Path]) -> None:
    file = written(places["script"] / "worlds" / "b.yaml")
    assert locate(file) == str(file)
    assert Path(locate("worlds/b.yaml")) == file
    assert locate(file.parent) == str(file.parent), "a directory is left to the reader"


def test_named_like_the_script(places: dict[str, Path]) -> None:
    assert default_name() == "my_run.yaml"
    file = written(places["script"] / "my_run.yaml")
    assert Path(locate()) == file


def not_found(wanted: str) -> str:
    with pytest.raises(ScenarioNotFoundError) as caught:
        locate(wanted)
    return str(caught.value)


def test_not_found_says_where_and_what_is_near(places: dict[str, Path]) -> None:
    written(places["first"] / "crossing.yaml")
    for wanted in ("crosing.yaml", "crossing"):
        message = not_found(wanted)
        assert all(str(folder) in message for folder in places.values())
        assert "Did you mean" in message
        assert "crossing.yaml" in message
    assert issubclass(ScenarioNotFoundError, FileNotFoundError)
    assert "Did you mean" not in not_found("entirely-different.yaml")


def test_hidden_folders_and_environments_are_not_named(
    places: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    for scripts in (places["here"] / ".tools" / "bin", places["first"] / "env" / "bin"):
        scripts.mkdir(parents=True)
        (scripts.parent / "pyvenv.cfg").touch()
        written(scripts / "halls.yaml")
        monkeypatch.setattr(sys, "path", [str(scripts), *sys.path])
        message = not_found("hall.yaml")
        assert str(places["here"]) in message
        assert str(scripts) not in message
        assert "Did you mean" not in message
    written(places["here"] / ".scenes" / "halls.yaml")
    assert "halls.yaml" in not_found(".scenes/hall.yaml"), "a hidden folder that the user names"


@pytest.mark.parametrize("wanted", ["doorway", "doorway.yaml", "templates/doorway", "templates/doorway/scenario.yaml"])
def test_the_name_of_a_template_says_how_to_make_a_file_of_it(places: dict[str, Path], wanted: str) -> None:
    last = not_found(wanted).splitlines()[-1]
    assert last == "'doorway' is a template: `irsim new doorway` writes doorway.yaml, which can then be used."
    assert last in not_found("dorway").splitlines()
    assert "is a template" not in not_found("entirely-different.yaml")
