"""Arguments of the wrong kind are refused in words: what is wrong, and what to give."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim import api
from irsim.benchmarks import BenchmarkError
from irsim.diagnostics.errors import ArgumentError

TEXT = """
world: {width: 10, height: 10, time_limit: 0.5}
robot:
  {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [9, 9], behavior: {name: dash}}
"""


@pytest.mark.parametrize("behavior", [{"name": "orca", "timeHorizon": 5}, "{name: orca, timeHorizon: 5}"])
def test_a_mapping_is_a_behavior_as_its_text_is(behavior: Any) -> None:
    for given in (behavior, [behavior], ["dash", behavior]):
        result = irsim.benchmark(TEXT, given, 1)
        assert result.behaviors[-1] == "{name: orca, timeHorizon: 5}"
        assert "{name: orca, timeHorizon: 5}'" in result.reproduce


def test_the_same_behavior_twice_is_found_out_whichever_way_it_is_written() -> None:
    with pytest.raises(BenchmarkError, match="given twice"):
        irsim.benchmark(TEXT, ["{name: orca, timeHorizon: 5}", {"name": "orca", "timeHorizon": 5}], 1)


_NOT_A_BEHAVIOR = r"(is not a valid behavior|is not a policy|a policy cannot be .+)"


@pytest.mark.parametrize("behaviors", [3, [None], [["orca"]], {"nam": "orca"}, [{}]])
def test_what_is_no_behavior_is_told(behaviors: Any) -> None:
    with pytest.raises(BenchmarkError, match=rf"{_NOT_A_BEHAVIOR}\. Fix: give a name") as told:
        irsim.benchmark(TEXT, behaviors, 1)
    assert told.value.where == "policies[0]"
    with pytest.raises(BenchmarkError, match=_NOT_A_BEHAVIOR):
        irsim.run(text=TEXT, behavior=behaviors)


@pytest.mark.parametrize(
    ("seeds", "meant"),
    [
        (3, [0, 1, 2]),
        ("3", [0, 1, 2]),
        ("5-7", [5, 6, 7]),
        (" 1, 4,7 ", [1, 4, 7]),
        ([4, 4, 2], [4, 2]),
        (range(2, 4), [2, 3]),
        (np.arange(2), [0, 1]),
        (np.int64(2), [0, 1]),
    ],
)
def test_seeds_mean_what_the_command_line_means(seeds: Any, meant: list[int]) -> None:
    assert irsim.benchmark(TEXT, "dash", seeds).seeds == meant


@pytest.mark.parametrize(
    "seeds", ["x", "9-2", "1.5", "", 1.5, True, None, [1.5], ["3"], [True], {"a": 1}, b"12", [[1]]]
)
def test_what_is_no_seed_is_told(seeds: Any) -> None:
    with pytest.raises(BenchmarkError, match=r"is not a valid seed or list of seeds\. Fix: give the number of seeds"):
        irsim.benchmark(TEXT, "dash", seeds)


@pytest.mark.parametrize("seeds", [10**12, "10000000", "0-99999999"])
def test_so_many_seeds_are_refused_before_they_are_listed(seeds: Any) -> None:
    with pytest.raises(BenchmarkError, match="seed"):
        irsim.benchmark(TEXT, "dash", seeds)


@pytest.mark.parametrize("steps", [-1, 1.5, 2.0, "2", True])
def test_steps_are_whole_numbers(steps: Any, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(TEXT, encoding="utf-8")
    calls: list[Callable[[], object]] = [
        lambda: irsim.run(text=TEXT, steps=steps),
        lambda: irsim.benchmark(TEXT, "dash", 1, steps=steps),
        lambda: api.render(tmp_path / "a.yaml", tmp_path / "a.png", steps=steps),
        lambda: api.snapshot(text=TEXT, steps=steps),
    ]
    for call in calls:
        with pytest.raises(ArgumentError, match=r"steps cannot be .*\. Fix: give a whole number, 0 or more\."):
            call()
    assert not (tmp_path / "a.png").exists()


def test_steps_of_numpy_and_none_at_all_are_taken() -> None:
    two: Any = np.int32(2)
    assert irsim.run(text=TEXT, steps=two).steps == 2
    assert irsim.run(text=TEXT, steps=0).steps == 0


@pytest.mark.parametrize("workers", [0, -1, 1.5, "2", True])
def test_workers_are_at_least_one(workers: Any) -> None:
    with pytest.raises(ArgumentError, match=r"workers cannot be .*\. Fix: give a whole number, 1 or more\."):
        irsim.benchmark(TEXT, "dash", 1, workers=workers)


@pytest.mark.parametrize("text", [b"world: {}", 3, ["a"], {"world": {}}])
def test_texts_are_strings(text: Any) -> None:
    calls: list[Callable[[], object]] = [
        lambda: irsim.validate(text=text),
        lambda: irsim.fix(text=text),
        lambda: irsim.run(text=text),
        lambda: irsim.diff(before_text=text, after_text=TEXT),
        lambda: irsim.validate(text=TEXT, base_text=text),
    ]
    for call in calls:
        with pytest.raises(ArgumentError, match=r"text must be a string, got .* Fix: (decode it|give the YAML)"):
            call()


@pytest.mark.parametrize("path", [b"a.yaml", 3, ["a.yaml"], {"world": {}}])
def test_paths_are_paths(path: Any) -> None:
    calls: list[Callable[[Any], object]] = [irsim.validate, irsim.run, irsim.fix]
    for call in calls:
        with pytest.raises(ArgumentError, match=r"path must be the path of a file, got .* Fix: give the path"):
            call(path)
    told = r"files\[0\] must be .*" if isinstance(path, (list, dict)) else "files must be .*"
    with pytest.raises(ArgumentError, match=told + "Fix: give a path"):
        irsim.benchmark([3] if isinstance(path, list) else path)  # type: ignore[list-item]


def test_imports_are_a_list() -> None:
    with pytest.raises(ArgumentError, match=r"give a list: imports=\['math'\]"):
        irsim.run(text=TEXT, imports="math")


@pytest.mark.parametrize(
    ("function", "wrong", "right"),
    [
        ("run", "seeed", "seed"),
        ("Env", "headles", "headless"),
        ("make", "save_anim", "save_ani"),
        ("batch", "thread", "threads"),
        ("benchmark", "policy", "policies"),
        ("episodes", "worker", "workers"),
        ("render", "stepz", "steps"),
        ("validate", "stric", "strict"),
        ("export_run", "range", "ranges"),
        ("connect", "bridge", "bridges"),
        ("replay", "limit", "limits"),
    ],
)
def test_a_misspelt_argument_is_answered_with_the_nearest_name(function: str, wrong: str, right: str) -> None:
    with pytest.raises(TypeError, match=rf"^{function}\(\) got .*'{wrong}'\. Did you mean '{right}'\?$"):
        getattr(irsim, function)("scene.yaml", **{wrong: 1})


@pytest.mark.parametrize("wrong", ["make_vec", "VectorEnv", "load", "export"])
def test_a_name_of_other_libraries_is_answered_with_the_one_to_use(wrong: str) -> None:
    with pytest.raises(AttributeError, match=rf"module 'irsim' has no attribute '{wrong}': use irsim\.\S+$") as caught:
        getattr(irsim, wrong)
    value: object = irsim
    for name in str(caught.value).rpartition("irsim.")[2].split("."):
        value = getattr(value, name)
    assert callable(value)
