"""The JSON Schema says what the models say, as far as a schema can."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.common.data_files import published_schema
from irsim.common.yaml.compose import compose
from irsim.options import registry
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.scenario.model.json_schema import INEXPRESSIBLE, check, json_schema, schema_text
from irsim.scenario.read import read
from tests.effort import examples
from tests.scenario.test_language import COMPLETE

pytestmark = pytest.mark.one_python

ROOT = Path(__file__).parent.parent.parent
VALID = sorted(ROOT.glob("templates/*/scenario.yaml")) + sorted(ROOT.glob("tests/parity/scenarios/*.yaml"))
CONTROLS = {"vel_min", "vel_max", "acce", "velocity"}

FULL = yaml.safe_load(COMPLETE)


@cache
def validator() -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(json_schema())


def test_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(json_schema())
    assert json_schema()["$schema"].endswith("2020-12/schema")


def test_the_committed_file_is_up_to_date(tmp_path: Path) -> None:
    assert check(ROOT / "schema" / "scenario.schema.json")
    stale = tmp_path / "stale.json"
    stale.write_text(schema_text().replace("heading", "bearing"), encoding="utf-8")
    assert not check(stale)
    assert not check(tmp_path / "missing.json")


@pytest.mark.parametrize("path", VALID, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_agrees_with_the_models_on_files_of_the_project(path: Path) -> None:
    data = compose(path.read_text(encoding="utf-8"), DEFAULT_LIMITS).data
    refused = any(item.code not in INEXPRESSIBLE for item in read(path, strict=True).errors)
    assert validator().is_valid(data) == (not refused)


def test_accepts_the_full_language() -> None:
    validator().validate(FULL)
    assert read(copy.deepcopy(FULL), strict=True).errors == []
    validator().validate({"irsim": FULL, "other": {"world": 3}})
    assert not validator().is_valid({"irsim": {"wrold": {}}, "other": 1})
    assert not validator().is_valid({"irsim": 3})


@pytest.mark.parametrize("name", ["Diff", "DIFF", "diff"])
def test_accepts_kinematics_and_shapes_in_any_case(name: str) -> None:
    data = {"robot": {"kinematics": {"name": name}, "shape": {"name": "CIRCLE"}, "behavior": {"name": "dash"}}}
    validator().validate(data)
    reading = read(data, strict=True)
    assert reading.scenario is not None
    assert getattr(reading.scenario.objects[0].kinematics, "name", "") == "diff"


def test_nodes_are_described() -> None:
    schema = json_schema()
    for name, definition in schema["$defs"].items():
        for key, node in definition.get("properties", {}).items():
            assert node.get("description"), f"{name}.{key} has no description"
            assert "title" not in node
    assert "pydantic" not in schema_text().lower()


def test_offers_every_feature() -> None:
    text = schema_text()
    for features in registry.REGISTRIES.values():
        for name in features.installed():
            assert f'"const": "{name}"' in text


def test_names_registered_by_user_code_are_part_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    data = {"robot": {"kinematics": {"name": "diff"}, "behavior": {"name": "zigzag", "width": 2}}}
    assert not validator().is_valid(data)
    monkeypatch.setattr(registry.CUSTOM_BEHAVIORS, "functions", {("diff", "zigzag"): print})
    assert jsonschema.Draft202012Validator(json_schema()).is_valid(data)
    assert "zigzag" not in schema_text()


def test_reasons_are_given() -> None:
    assert all(reason for reason in INEXPRESSIBLE.values())
    assert published_schema() in schema_text()
    assert all(reason in json_schema()["$comment"] for reason in INEXPRESSIBLE.values())


def paths(node: Any, prefix: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if prefix:
        yield prefix
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, child in items:
        if key not in (
            "custom",
            "obstacle_map",
        ):  # anything goes; a text names a file, which the schema cannot look for
            yield from paths(child, (*prefix, key))


VALUES = [
    None, True, False, -1, 0, 1, 3, 2.5, -0.5, 1.5e9 + 0.5, "diff", "circle", "random", "dash", "lidar2d",
    "red", "", "x",
    [], [1], [1, 2], [1, 2, 3], [0.5, "a"], [[1, 2], [3, 4]], [[[1, 2], [3, 4]]], {}, {"name": "diff"},
    {"name": "circle"},
    {"name": "nothing"}, [{"name": "circle"}], [{"name": "lidar2d"}], [None], ["a", "b"], [True], {"radius": 1},
]  # fmt: skip
REMOVE = "(remove)"


@given(
    st.lists(
        st.tuples(st.sampled_from(list(paths(FULL))), st.sampled_from([*VALUES, REMOVE, "(unknown key)"])),
        min_size=1,
        max_size=2,
    )
)
@settings(max_examples=examples(400))
def test_agrees_with_the_models_on_damaged_files(changes: list[tuple[tuple[Any, ...], Any]]) -> None:
    data = copy.deepcopy(FULL)
    for path, value in changes:
        damage(data, path, value)
    reading = read(copy.deepcopy(data), strict=True)
    accepted = validator().is_valid(data)
    errors = [(item.code, item.path) for item in reading.errors]
    ignored = [item for item in reading.diagnostics if item.code == "behavior-without-kinematics"]
    if not accepted and not ignored:  # where nothing moves, the models ignore the name of the behavior
        assert errors, json.dumps(data)
    told = [(code, path) for code, path in errors if code not in INEXPRESSIBLE]
    told = [(code, path) for code, path in told if code != "wrong-length" or not CONTROLS & set(path)]
    assert not (told and accepted), f"{told} in {json.dumps(data)}"


def damage(data: Any, path: tuple[Any, ...], value: Any) -> None:
    for key in path[:-1]:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return
    if isinstance(data, dict) and path[-1] in data:
        if value == REMOVE:
            del data[path[-1]]
        elif value == "(unknown key)":
            data["unknown_key"] = 1
        else:
            data[path[-1]] = copy.deepcopy(value)
    elif isinstance(data, list) and isinstance(path[-1], int) and path[-1] < len(data) and value != REMOVE:
        data[path[-1]] = copy.deepcopy(value)
