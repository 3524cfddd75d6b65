"""Inputs made to hurt: each is answered with one clear error, soon."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from irsim.scenario.limits import Limits
from irsim.scenario.read import read

SLOW_MACHINE = 5.0  # bounds below are for this many times the time an idle laptop takes


@contextmanager
def within(seconds: float) -> Iterator[None]:
    start = time.process_time()
    yield
    assert time.process_time() - start < seconds


def codes(text: str, **options: Limits) -> list[str]:
    return [item.code for item in read(text, **options).errors]


def merge_bomb() -> str:
    lines = ["a: &a {k0: 0, k1: 0, k2: 0, k3: 0, k4: 0, k5: 0, k6: 0, k7: 0, k8: 0, k9: 0}"]
    for previous, name in zip("abcdef", "bcdefg", strict=True):
        lines.append(f"{name}: &{name} {{<<: [{', '.join(['*' + previous] * 10)}]}}")
    return "\n".join(lines) + "\n"


def alias_bomb() -> str:
    lines = ['a: &a ["lol", "lol", "lol", "lol", "lol", "lol", "lol", "lol", "lol"]']
    for previous, name in zip("abcdefgh", "bcdefghi", strict=True):
        lines.append(f"{name}: &{name} [{', '.join(['*' + previous] * 9)}]")
    return "\n".join(lines) + "\n"


def test_merge_bomb() -> None:
    bomb = merge_bomb()
    assert 300 < len(bomb) < 500
    with within(0.1 * SLOW_MACHINE):
        assert codes(bomb) == ["alias-expansion"]


def nested_merges() -> str:
    """Each mapping merges a list of mappings that merge lists, all in one document of few bytes."""
    inner = "{k0: 0, k1: 0, k2: 0}"
    for name in "abcde":
        inner = f"{{<<: [&{name} {inner}, {', '.join(['*' + name] * 12)}], own_{name}: 1}}"
    return f"world: {inner}\n"


def merges_below_merges() -> str:
    """Merge keys whose values are merge keys again, and lists of the same bomb beside them."""
    return merge_bomb() + "robot: [" + ", ".join(["{<<: {<<: [*g, *g]}}"] * 20) + "]\n"


def wide_merge() -> str:
    keys = ", ".join(f"k{number}: 0" for number in range(1000))
    return f"a: &a {{{keys}}}\nb: [" + ", ".join(["{<<: [*a, *a, *a, *a]}"] * 1000) + "]\n"


@pytest.mark.skipif(sys.platform != "linux", reason="measures the memory of a process")
@pytest.mark.parametrize("bomb", [merge_bomb, nested_merges, merges_below_merges, wide_merge])
def test_merge_keys_cost_neither_time_nor_memory(bomb: Callable[[], str]) -> None:
    """In a process of its own, whose memory is its own."""
    code = (
        "import json, resource, sys, time\nfrom irsim.scenario.read import read\n"
        "text = sys.stdin.read()\nread('world: {width: 5}')\n"
        "most = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "before, begin = most(), time.process_time()\ncodes = [item.code for item in read(text).errors]\n"
        "print(json.dumps([codes, time.process_time() - begin, (most() - before) / 1024]))"
    )
    done = subprocess.run([sys.executable, "-c", code], input=bomb(), capture_output=True, text=True, check=True)
    codes, seconds, megabytes = json.loads(done.stdout)
    assert "alias-expansion" in codes
    assert seconds < 0.1 * SLOW_MACHINE
    assert megabytes < 20


def test_alias_bomb() -> None:
    with within(0.1 * SLOW_MACHINE):
        assert codes(alias_bomb()) == ["alias-expansion"]


def test_alias_bomb_as_robots() -> None:
    text = "custom: &r {kinematics: {name: diff}}\nrobot: [" + ", ".join(["*r"] * 100_000) + "]\n"
    with within(2 * SLOW_MACHINE):
        reading = read(text, limits=Limits(objects=50_000))
    assert [item.code for item in reading.errors] == ["too-many-objects"]


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "? "])
def test_deep_nesting(opening: str) -> None:
    with within(0.5 * SLOW_MACHINE):
        assert codes("custom:\n  " + opening * 30_000 + "\n") in (["too-deep"], ["yaml-syntax"])


def test_seventeen_megabytes(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    path.write_bytes(b"# padding\n" * (17 * 1024 * 1024 // 10 + 1))
    with within(0.2 * SLOW_MACHINE):
        assert [item.code for item in read(path).errors] == ["file-too-large"]


def test_a_sparse_terabyte(tmp_path: Path) -> None:
    path = tmp_path / "huge.yaml"
    with open(path, "wb") as file:
        os.truncate(file.fileno(), 2**40)
    with within(0.2 * SLOW_MACHINE):
        assert [item.code for item in read(path).errors] == ["file-too-large"]


@pytest.mark.slow(6)
def test_a_million_keys() -> None:
    text = "\n".join(f"k{i}: 1" for i in range(1_000_000)) + "\n"
    with within(4 * SLOW_MACHINE):
        reading = read(text)
    assert "too-many-events" in [item.code for item in reading.errors]
    assert len(reading.diagnostics) <= 101


@pytest.mark.slow(4)
def test_a_hundred_thousand_unknown_keys() -> None:
    text = "world:\n" + "\n".join(f"  k{i}: 1" for i in range(100_000)) + "\n"
    with within(4 * SLOW_MACHINE):
        reading = read(text)
    assert len(reading.diagnostics) == 101
    assert {item.code for item in reading.diagnostics} == {"unknown-key", "too-many-problems"}


@pytest.mark.parametrize("number", ["1000000", "1000000000000000000000", "99999999"])
def test_a_million_robots(number: str) -> None:
    text = f"robot:\n  - {{number: {number}, kinematics: {{name: diff}}}}\n"
    with within(0.2 * SLOW_MACHINE):
        assert codes(text) == ["too-many-objects"]


def test_many_entries_of_many() -> None:
    text = "obstacle:\n" + "  - {number: 50000}\n" * 3
    reading = read(text)
    assert [(item.code, item.path, item.line) for item in reading.errors] == [
        ("too-many-objects", ("obstacle", 2, "number"), 4)
    ]
    assert codes("obstacle: {number: 30}\n", limits=Limits(objects=20)) == ["too-many-objects"]


@pytest.mark.parametrize(
    "text",
    [
        "a: " + "9" * 5000 + "\n",
        "world: {height: " + "9" * 5000 + "}\n",
        "world: {height: " + "1" * 390 + "}\n",
        "world: {seed: 99999999999999999999}\n",
        "robot: {number: 1.0e+300}\n",
        "robot: {state: [1.0e+999, 0, 0]}\n",
    ],
)
def test_monstrous_numbers(text: str) -> None:
    with within(0.2 * SLOW_MACHINE):
        reading = read(text)
    assert reading.scenario is None
    assert reading.errors


@pytest.mark.parametrize("kind", ["directory", "/dev/null", "/dev/zero", "fifo", "binary", "unreadable"])
def test_a_file_that_is_not_text_is_reported(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "scenario.yaml"
    if kind == "directory":
        path.mkdir()
    elif kind.startswith("/dev"):
        path = Path(kind)
    elif kind == "fifo":
        os.mkfifo(path)
    elif kind == "binary":
        path.write_bytes(bytes(range(256)) * 100)
    else:
        path.symlink_to(path)
    with within(0.2 * SLOW_MACHINE):
        (problem,) = read(path).errors
    assert problem.code in ("not-a-file", "not-text", "unreadable")


@pytest.mark.parametrize(
    "text",
    [
        "#!/usr/bin/env python\nimport os\nprint(os.getcwd())\n",
        "<html>\n<body>Not found</body></html>\n",
        '{"world": {"height": 10},}\n}',
        "Hello,\nworld\n",
        "- 1\n- 2\n",
        "42\n---\n",
        "world\n",
    ],
)
def test_data_that_are_not_a_scenario_are_reported(text: str) -> None:
    reading = read(text)
    assert reading.scenario is None
    assert len(reading.errors) >= 1


def test_tags_construct_nothing(tmp_path: Path) -> None:
    marker = tmp_path / "made"
    text = f"custom: !!python/object/apply:os.mkdir ['{marker}']\nworld: {{widht: 3}}\n"
    reading = read(text)
    assert [item.code for item in reading.diagnostics] == ["unsupported-tag", "unknown-key"]
    assert not marker.exists()


def test_control_characters_do_not_reach_the_terminal() -> None:
    from irsim.diagnostics.report import format_diagnostics

    text = 'world: {widht: 3, name: "\u009b31m"}  # \x1b[2J\n'
    reading = read(text)
    assert "\x1b" not in format_diagnostics(reading.diagnostics, text)
