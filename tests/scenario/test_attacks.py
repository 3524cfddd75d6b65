"""Hostile files: each is refused with a clear error, soon, and leads to no other file."""

from __future__ import annotations

import functools
import itertools
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.report import format_diagnostics
from irsim.options.registry import REGISTRIES
from irsim.scenario.limits import Limits
from irsim.scenario.locate import why_outside
from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_path, load_text

SLOW_MACHINE = 5.0  # bounds below are for this many times the time an idle laptop takes


@contextmanager
def within(seconds: float) -> Iterator[None]:
    start = time.process_time()
    yield
    assert time.process_time() - start < seconds


def codes(text: str, **options: Limits) -> list[str]:
    return [item.code for item in read(text, **options).errors]


def bomb(first: str, level: str, names: str) -> str:
    """Each line holds the one before ten times."""
    lines = [first] + [level.format(name, ", ".join([f"*{last}"] * 10)) for last, name in itertools.pairwise(names)]
    return "\n".join(lines) + "\n"


def merge_bomb() -> str:
    return bomb("a: &a {" + ", ".join(f"k{key}: 0" for key in range(10)) + "}", "{0}: &{0} {{<<: [{1}]}}", "abcdefg")


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


DEEP = {opening: "custom:\n  " + opening * 30_000 + "\n" for opening in ("[", "{a: ", "- ", "? ")}
HERD = "robot:\n  - {{number: {}, kinematics: {{name: diff}}}}\n"


@pytest.mark.parametrize(
    ("text", "code", "seconds"),
    [
        (merge_bomb(), "alias-expansion", 0.1),
        (bomb('a: &a ["lol", "lol"]', "{0}: &{0} [{1}]", "abcdefghi"), "alias-expansion", 0.1),
        *((text, "too-deep|yaml-syntax", 0.5) for text in DEEP.values()),
        *((HERD.format(n), "too-many-objects", 0.2) for n in ("1000000", "1000000000000000000000", "99999999")),
    ],
    ids=["merge bomb", "alias bomb", *DEEP, "a million", "10^21", "99999999"],
)
def test_what_grows_is_refused_soon(text: str, code: str, seconds: float) -> None:
    with within(seconds * SLOW_MACHINE):
        (refused,) = codes(text)
    assert refused in code.split("|")


def test_alias_bomb_as_robots() -> None:
    text = "custom: &r {kinematics: {name: diff}}\nrobot: [" + ", ".join(["*r"] * 100_000) + "]\n"
    with within(2 * SLOW_MACHINE):
        reading = read(text, limits=Limits(objects=50_000))
    assert [item.code for item in reading.errors] == ["too-many-objects"]


@pytest.mark.parametrize("size", [17 * 2**20, 2**40], ids=["17 MB", "a sparse terabyte"])
def test_large_files(tmp_path: Path, size: int) -> None:
    path = tmp_path / "large.yaml"
    path.write_bytes(b"# padding\n" * (17 * 2**20 // 10 if size < 2**30 else 0))
    os.truncate(path, size)
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


def test_many_entries_of_many() -> None:
    text = "obstacle:\n" + "  - {number: 50000}\n" * 3
    reading = read(text)
    (error,) = reading.errors
    assert (error.code, error.path, error.line) == ("too-many-objects", ("obstacle", 2, "number"), 4)
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
        "#!/usr/bin/env python\nimport os\nprint(os.getcwd())\n",
        "<html>\n<body>Not found</body></html>\n",
        '{"world": {"height": 10},}\n}',
        "Hello,\nworld\n",
        "- 1\n- 2\n",
        "42\n---\n",
        "world\n",
    ],
)
def test_monstrous_numbers_and_what_is_no_scenario_are_refused(text: str) -> None:
    with within(0.2 * SLOW_MACHINE):
        reading = read(text)
    assert reading.scenario is None
    assert reading.errors


SPECIAL: dict[str, Callable[[Path], object]] = {
    "directory": Path.mkdir,
    "fifo": os.mkfifo,
    "binary": lambda path: path.write_bytes(bytes(range(256)) * 100),
    "unreadable": lambda path: path.symlink_to(path),
    **{device: functools.partial(Path.symlink_to, target=device) for device in ("/dev/null", "/dev/zero")},
}


@pytest.mark.parametrize("kind", SPECIAL)
def test_a_file_that_is_not_text_is_reported(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "scenario.yaml"
    SPECIAL[kind](path)
    with within(0.2 * SLOW_MACHINE):
        (problem,) = read(path).errors
    assert problem.code in ("not-a-file", "not-text", "unreadable")


def test_tags_construct_nothing(tmp_path: Path) -> None:
    marker = tmp_path / "made"
    text = f"custom: !!python/object/apply:os.mkdir ['{marker}']\nworld: {{widht: 3}}\n"
    reading = read(text)
    assert [item.code for item in reading.diagnostics] == ["unsupported-tag", "unknown-key"]
    assert not marker.exists()


def test_control_characters_do_not_reach_the_terminal() -> None:
    text = 'world: {widht: 3, name: "\u009b31m"}  # \x1b[2J\n'
    reading = read(text)
    assert "\x1b" not in format_diagnostics(reading.diagnostics, text)


POSIX = pytest.mark.skipif(sys.platform == "win32", reason="links and pipes of POSIX")


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "root"
    (root / "maps").mkdir(parents=True)
    (root / "maps" / "a.png").write_bytes(b"")
    (tmp_path / "secret.png").write_bytes(b"")
    return root


@pytest.mark.parametrize(
    ("name", "why"),
    [
        *(
            (name, None)
            for name in ("maps/a.png", "./maps/a.png", "maps//a.png", "not-there.png", "a..b", "地图　1.png")
        ),
        ("../secret.png", "leads upwards"),
        ("maps/../../secret.png", "leads upwards"),
        ("maps\\..\\..\\secret.png", "leads upwards"),
        ("/etc/passwd", "absolute"),
        ("C:\\secret.png", "absolute"),
        ("C:secret.png", "absolute"),
        ("\\\\host\\share\\secret.png", "absolute"),
        ("//host/share/secret.png", "absolute"),
        ("~/secret.png", "home"),
        ("~root/secret.png", "home"),
        ("maps/a.png\0", "control character"),
        ("maps/\u202egnp.a", "control character"),
        ("maps/nul.png", "device"),
        ("maps/" + "x" * 5000, "cannot be followed"),
    ],
)
def test_only_names_that_lead_downwards_pass(root: Path, name: str, why: str | None) -> None:
    reason = why_outside(name, root)
    assert (reason is None) if why is None else why in str(reason)


@POSIX
def test_links_count_as_what_they_lead_to(root: Path) -> None:
    (root / "inside.png").symlink_to(root / "maps" / "a.png")
    (root / "outside.png").symlink_to(root.parent / "secret.png")
    (root / "folder").symlink_to(root.parent)
    (root / "ring").symlink_to("ring")
    os.mkfifo(root / "pipe.png")  # would be waited for
    (root.parent / "link").symlink_to(root)
    assert why_outside("inside.png", root) is None
    assert why_outside("maps/a.png", root.parent / "link") is None
    for name in ("outside.png", "folder/secret.png"):
        assert "link that leads out" in str(why_outside(name, root))
    for name in ("ring", "ring/a.png"):
        assert "cannot be followed" in str(why_outside(name, root))
    assert "pipe" in str(why_outside("pipe.png", root))


def test_every_file_of_a_scenario_is_looked_at(root: Path) -> None:
    text = (
        "world: {obstacle_map: {name: ros, path: ../map.yaml}}\n"
        "robot:\n  - {number: 2, state: [[1, 1], [5, 5]], description: [car_blue.png, /etc/car.png]}\n"
        "obstacle: {description: ../wall.png}\n"
    )
    lines = {
        format_path(item.path): item.line
        for item in read(load_text(text, limits=Limits(root=str(root)))).errors
        if item.code == "path-outside-workspace"
    }
    assert lines == {"world.obstacle_map.path": 1, "robot[0].description[1]": 3, "obstacle.description": 4}
    assert not [item for item in read(load_text(text)).errors if item.code == "path-outside-workspace"]


@POSIX
def test_names_count_from_the_folder_of_the_scenario_too(root: Path) -> None:
    (root / "maps" / "link.png").symlink_to(root.parent / "secret.png")
    scenario = root / "maps" / "room.yaml"
    scenario.write_text("world: {obstacle_map: link.png}\n", encoding="utf-8")
    errors = read(load_path(scenario, Limits(root=str(root)))).errors
    assert "path-outside-workspace" in [item.code for item in errors]


def test_the_options_that_name_files_are_known() -> None:
    keys = {
        f"{kind}.{name}"
        for kind, registry in REGISTRIES.items()
        for feature in registry.features()
        if feature.origin == "built-in"
        for name in feature.options.model_fields
        if any(word in name for word in ("path", "file", "image", "picture"))
    }
    assert keys == {"map.path", "planner.path_resolution"}
