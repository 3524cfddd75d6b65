"""Items of lists are inserted, deleted and copied in the text of a scenario; every other line stays as it is."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.common.yaml.tree import same_data
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.yaml.comments import keeps_comments
from irsim.scenario.yaml.edits import apply_edits
from irsim.scenario.yaml.rewrite import rewrite
from tests.effort import examples
from tests.scenario.test_mend import paths, trees

TEMPLATES = sorted((Path(__file__).parents[2] / "templates").glob("*/scenario.yaml"))
NEW = {"name": "new", "state": [1, 2, 0], "shape": {"name": "circle", "radius": 0.2}}
SCENE = """\
robot:
  - name: a   # the first
    state: [1, 1, 0]
    plot: &look {show_goal: true}
  # about b
  - name: b
    plot: *look
obstacle: []   # nothing yet
world: {width: 10}
"""


@pytest.mark.parametrize(
    ("text", "edit", "changed"),
    [
        ("a:\n- 1\n- 2  # two\n", Edit("insert", ("a", 2), 3), "a:\n- 1\n- 2  # two\n- 3\n"),
        ("a:\n- 1\n# two\n- 2\n", Edit("insert", ("a", 1), 3), "a:\n- 1\n- 3\n# two\n- 2\n"),
        ("a:\n  - 1", Edit("insert", ("a", 1), 3), "a:\n  - 1\n  - 3"),
        ("a:\r\n  - 1\r\n", Edit("insert", ("a", 0), 3), "a:\r\n  - 3\r\n  - 1\r\n"),
        ("a: [1, 2]  # both\n", Edit("insert", ("a", 1), 3), "a: [1, 3, 2]  # both\n"),
        ("a: []\n", Edit("insert", ("a", 0), {"k": 1}), "a: [{k: 1}]\n"),
        ("a: [1, 2]\n", Edit("insert", ("a", 3), 3), None),
        ("a:\n- k: 1\n", Edit("insert", ("a", 1), {"k": 2, "l": 3}), "a:\n- k: 1\n- k: 2\n  l: 3\n"),
        ("a:\n- {k: 1}\n", Edit("insert", ("a", 1), {"k": 2}), "a:\n- {k: 1}\n- {k: 2}\n"),
        ("a:\n  k: 1  # why\nb: 2\n", Edit("insert", ("a", 1), {"k": 2}), "a:\n  - k: 1  # why\n  - k: 2\nb: 2\n"),
        ("a: {k: 1}\n", Edit("insert", ("a", 1), {"k": 2}), "a:\n  - {k: 1}\n  - {k: 2}\n"),
        ("b: 1\n", Edit("insert", ("a", 0), {"k": 2}), "b: 1\na:\n  - {k: 2}\n"),
        ("a:\n- 1\n- 2\n", Edit("delete", ("a", 0)), "a:\n- 2\n"),
        ("a:\n  # why\n  - 1\nb: 2\n", Edit("delete", ("a", 0)), "a: []\n  # why\nb: 2\n"),
        ("a: [1, 2, 3]\n", Edit("delete", ("a", 1)), "a: [1, 3]\n"),
        ("a: [1]\n", Edit("delete", ("a", 0)), "a: []\n"),
        ("- - 1\n  - 2\n- 3\n", Edit("delete", (0, 0)), "- - 2\n- 3\n"),
        ("a:\n- k: &x 1\n- k: *x\n", Edit("delete", ("a", 0)), "a:\n- k: &x 1\n"),
        ("a:\n- k: &x 1\n- l: *x\n", Edit("duplicate", ("a", 0)), "a:\n- k: &x 1\n- k: 1\n- l: *x\n"),
        ("a: [1, {k: 2}]\n", Edit("duplicate", ("a", 1)), "a: [1, {k: 2}, {k: 2}]\n"),
        ("a: &x [1]\nb: *x\n", Edit("insert", ("b", 1), 2), None),  # would change a as well
        ("a: 1\n", Edit("delete", ("a", 0)), None),
        ("a: {b: 1}\n", Edit("duplicate", ("a", "b")), None),
    ],
)
def test_what_is_written(text: str, edit: Edit, changed: str | None) -> None:
    assert rewrite(text, edit) == changed


def test_names_of_values_are_handed_on_and_comments_stay() -> None:
    without = rewrite(SCENE, Edit("delete", ("robot", 0)))
    assert without is not None
    assert without.startswith("robot:\n  # about b\n  - name: b\n    plot: &look {show_goal: true}\n")
    twice = rewrite(SCENE, Edit("duplicate", ("robot", 0)))
    assert twice is not None
    assert twice.count("# the first") == 2
    assert twice.count("&look") == 1
    filled = rewrite(SCENE, Edit("insert", ("obstacle", 0), NEW))
    assert filled is not None
    assert "# nothing yet" in filled


@pytest.mark.parametrize("file", TEMPLATES, ids=lambda file: file.parent.name)
def test_every_object_of_a_template_is_copied_and_deleted_and_another_one_added(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    data = yaml.safe_load(text)
    for role in ("robot", "obstacle"):
        given = data.get(role, [])
        count = len(given) if isinstance(given, list) else 1
        edits = [Edit("insert", (role, count), NEW)]
        if isinstance(given, list):
            edits += [Edit(action, (role, k)) for action in ("delete", "duplicate") for k in range(count)]
        for edit in edits:
            changed = rewrite(text, edit)
            assert changed is not None, edit
            assert yaml.safe_load(changed) == apply_edits(data, [edit])
            lines = [line for line in difflib.ndiff(text.splitlines(), changed.splitlines()) if line[0] in "+-"]
            if edit.action == "delete":
                assert sum(line[0] == "+" for line in lines) <= 1, lines  # a name that is handed on, or []
            elif isinstance(given, list):
                assert all(line[0] == "+" for line in lines), lines
            if edit.action != "delete":
                assert keeps_comments(text, changed)


@settings(max_examples=examples(200))
@given(
    st.dictionaries(st.text("xyz", min_size=1, max_size=3), trees, min_size=1, max_size=4),
    trees,
    st.data(),
    st.sampled_from([True, False, None]),
)
def test_the_text_means_what_the_edit_means(
    data: dict[str, Any], value: Any, draw: st.DataObject, flow: bool | None
) -> None:
    text = yaml.safe_dump(data, default_flow_style=flow, allow_unicode=True, sort_keys=False)
    path = draw.draw(st.sampled_from([path for path in paths(data) if path]))
    index = draw.draw(st.integers(0, 3))
    for edit in (Edit("insert", (*path, index), value), Edit("delete", path), Edit("duplicate", path)):
        changed = rewrite(text, edit)
        if changed is not None:
            assert same_data(yaml.safe_load(changed), apply_edits(data, [edit]), near=1e-9)
