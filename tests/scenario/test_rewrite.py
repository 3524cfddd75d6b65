"""Edits of the text: what is asked changes, every other character stays."""

from __future__ import annotations

from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.yaml.edits import apply_edits
from irsim.scenario.yaml.rewrite import rewrite, yaml_flow
from tests.effort import examples

TEXT = """\
# a scene
world:
  width: 10        # m
  plot: {grid: true,  title: 'a # b'}   # drawn

robot:
  - name: a        # first
    goal: [1, 2]   # there
    behavior:
      name: dash   # straight
      loop: true
    # last words
  - {name: b, goal: [3, 4]}   # second
obstacle:
"""


@pytest.mark.parametrize(
    ("edit", "before", "after"),
    [
        (Edit("replace", ("world", "width"), 12.5), "  width: 10        # m", "  width: 12.5        # m"),
        (Edit("rename", ("robot", 0, "goal"), "waypoints"), "    goal: [1, 2]", "    waypoints: [1, 2]"),
        (Edit("remove", ("robot", 0, "goal")), "    goal: [1, 2]   # there", "    # there"),
        (Edit("remove", ("robot", 0, "name")), "  - name: a        # first\n    goal", "  - goal"),
        (Edit("remove", ("robot", 1, "goal")), "{name: b, goal: [3, 4]}", "{name: b}"),
        (Edit("remove", ("robot", 1, "name")), "{name: b, goal", "{goal"),
        (Edit("remove", ("world", "plot", "grid")), "{grid: true,  title", "{title"),
        (Edit("add", ("robot", 1, "group"), 2), "goal: [3, 4]}", "goal: [3, 4], group: 2}"),
        (
            Edit("add", ("robot", 0, "vel_min"), [0, -1.5]),
            "      loop: true\n    # last",
            "      loop: true\n    vel_min: [0, -1.5]\n    # last",
        ),
        (Edit("replace", ("robot", 0, "behavior"), {"name": "orca"}), None, None),
        (Edit("replace", ("obstacle",), []), "obstacle:", "obstacle: []"),
        (Edit("replace", ("world", "plot", "title"), "yes"), "'a # b'", "'yes'"),
        (Edit("replace", ("robot", 0), "gone"), None, None),
    ],
)
def test_changes_one_place(edit: Edit, before: str | None, after: str | None) -> None:
    changed = rewrite(TEXT, edit)
    assert changed is not None
    assert yaml.safe_load(changed) == apply_edits(yaml.safe_load(TEXT), [edit])
    if before is not None and after is not None:
        assert TEXT.count(before) == 1
        assert changed == TEXT.replace(before, after)


def test_only_pair_of_a_mapping_leaves_an_empty_one() -> None:
    assert rewrite("a:\n  b: 1  # why\nc: 2\n", Edit("remove", ("a", "b"))) == "a:\n  {}  # why\nc: 2\n"


def test_windows_line_ends_stay() -> None:
    assert rewrite("a: 1\r\nb: 2\r\n", Edit("add", ("c",), 3)) == "a: 1\r\nb: 2\r\nc: 3\r\n"
    assert rewrite("a: 1\r\nb: 2\r\n", Edit("remove", ("a",))) == "b: 2\r\n"


@pytest.mark.parametrize(
    ("text", "edit"),
    [
        ("a: &x {k: 1}\nb: *x\n", Edit("replace", ("a", "k"), 2)),  # would change b as well
        ("a: &x {k: 1}\nb: *x\n", Edit("replace", ("b", "k"), 2)),
        ("a: &x {k: 1}\nb: *x\n", Edit("add", ("b", "l"), 2)),
        ("a: &x {k: 1}\nb: {<<: *x}\n", Edit("replace", ("b", "k"), 2)),
        ("a: 1\n", Edit("replace", ("b",), 2)),
        ("a: 1\n", Edit("rename", ("b", "c"), "d")),
        ("a: [1]\n", Edit("remove", ("a", 0))),
        ("a: {b: 1}\n", Edit("add", ("a", "b"), 2)),
        ("a: [", Edit("remove", ("a",))),
    ],
)
def test_leaves_alone_what_it_cannot_change_by_itself(text: str, edit: Edit) -> None:
    assert rewrite(text, edit) is None


def test_an_alias_itself_can_be_renamed_or_left_out() -> None:
    text = "a: &x {k: 1}\nb: 2\nc: 3\n"
    assert rewrite(text, Edit("remove", ("b",))) == "a: &x {k: 1}\nc: 3\n"


scalars = (
    st.none() | st.booleans() | st.integers(-99, 99) | st.floats(-1e6, 1e6) | st.text("abc #:-'\"[]{}é\n", max_size=6)
)
trees = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text("abcd", min_size=1, max_size=3), inner, max_size=3)
    ),
    max_leaves=8,
)


def paths(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(deeper for key, item in items for deeper in paths(item, (*path, key)))]


@settings(max_examples=examples(150))
@given(
    st.dictionaries(st.text("xyz", min_size=1, max_size=3), trees, min_size=1, max_size=4),
    trees,
    st.data(),
    st.booleans(),
)
def test_the_text_means_what_the_edit_means(data: dict[str, Any], value: Any, draw: st.DataObject, flow: bool) -> None:
    text = yaml.safe_dump(data, default_flow_style=flow, allow_unicode=True, sort_keys=False)
    places = [path for path in paths(data) if path]
    path = draw.draw(st.sampled_from(places))
    action = draw.draw(st.sampled_from(["remove", "replace", "rename", "add"]))
    edit = Edit(action, (*path[:-1], "new") if action == "add" else path, "renamed" if action == "rename" else value)
    changed = rewrite(text, edit)
    if changed is not None:
        assert _near(yaml.safe_load(changed), apply_edits(data, [edit]))


@settings(max_examples=examples(200))
@given(trees)
def test_a_value_on_one_line_is_read_back(value: Any) -> None:
    line = yaml_flow(value)
    assert "\n" not in line
    back = yaml.safe_load(f"[{line}]")[0]
    assert back == pytest.approx(value, rel=1e-9) if isinstance(value, float) else back == value or _near(back, value)


def _near(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_near(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_near, a, b))
    return bool(a == b or (isinstance(a, (int, float)) and a == pytest.approx(b, rel=1e-9)))
