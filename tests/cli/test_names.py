"""Options have one meaning in all commands, long help is grouped, values complete, and paths are printed in one way."""

from __future__ import annotations

import os
import random
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

from irsim.cli.app import COMMANDS, TOOLS, app
from irsim.cli.completion import offers
from irsim.cli.names import OLD_NAMES, REFUSED
from irsim.lookup import lookup
from tests.cli.conftest import Run

pytestmark = pytest.mark.one_python
ROOT = Path(__file__).resolve().parents[2]
MEANINGS = {
    "--add-robot": "Add a robot",
    "--behavior": "policy|Behavior of the robot",
    "--csv": "comma-separated values",
    "--end": "End of the window of time",
    "--force": "Overwrite",
    "--import": "import a Python module",
    "--json": "JSON",
    "--max-objects": "Maximum number of objects",
    "--objects": "objects?, or|obstacles that can move",
    "--out": "[Ff]ile|to write|Folder (of|for)|Picture",
    "--perturb": "Let the seed change starts",
    "--policies": "behaviors|Behaviors",
    "--policy": "every robot",
    "--port": "[Pp]ort of the page",
    "--no-browser": "open no browser",
    "--radius": "^Radius of a pedestrian",
    "--resolution": "Side of a cell",
    "--resume": "Go on with the",
    "--rotate": "^Turn",
    "--run": "Id or folder of a run",
    "--seed": "^Random seed.*0 or more",
    "--seeds": "their number from 0, or a list of seeds: 20, 5-9, 1,4,7",
    "--set": "^Set KEY to VALUE, ",
    "--simulate": "[Ss]imulate",
    "--start": "Start of the window of time",
    "--step-time": "Step time",
    "--step": "picture (of this step|shows the state after N steps)",
    "--steps": "^Maximum number of steps",
    "--strict": "Treat tolerated problems",
    "--verbose": "^Also print",
    "--workers": "[Pp]rocesses",
    "-v": "^Also print",
    "-o": "[Ff]ile|to write|Folder (of|for)|Picture",
}
"""An option of several commands -> what its help says in each of them; a new option of that name means the same."""


def commands(command: Any, words: str) -> Iterator[tuple[str, Any]]:
    """All commands below one, each with its words."""
    inner = getattr(command, "commands", None)
    if inner is None:
        yield words, command
    for name, one in (inner or {}).items():
        yield from commands(one, f"{words} {name}")


def every_command() -> list[tuple[str, Any]]:
    group: Any = typer.main.get_command(app)
    return [one for name in COMMANDS for one in commands(group.get_command(None, name), name)]


def test_an_option_has_one_meaning_in_all_commands() -> None:
    helps: dict[str, dict[str, tuple[bool, str]]] = defaultdict(dict)
    for words, command in every_command():
        for one in command.params:
            for name in (*one.opts, *one.secondary_opts) if one.param_type_name == "option" else ():
                helps[name][words] = bool(one.is_flag), " ".join((one.help or "").split())
    shared = {name: told for name, told in helps.items() if len(told) > 1}
    assert sorted(shared) == sorted(MEANINGS)
    for name, told in shared.items():
        assert len({flag for flag, _ in told.values()}) == 1, f"{name} is a flag of some commands only: {told}"
        odd = {words: text for words, (_, text) in told.items() if not re.search(MEANINGS[name], text)}
        assert odd == {}, name


def test_older_names_of_options_still_work_and_are_in_no_help(irsim: Run, room: Path) -> None:
    known = dict(every_command())
    for words, names in OLD_NAMES.items():
        own = {name for one in known[words].params for name in one.opts}
        assert own.isdisjoint(names)
        assert own.issuperset(names.values())
    irsim("run", "room.yaml", "--record-to", "kept", code=0)
    new = irsim("inspect", "kept", "--first", "3", "--last", "9", "--objects", "all", code=0).stdout
    assert irsim("inspect", "kept", "--from", "3", "--to=9", "--robot", "all", code=0).stdout == new


def said(text: str) -> str:
    """The message of Click, without the frame and the breaks of its lines."""
    return " ".join(re.sub("[│╭╰─╮╯]", " ", text).split())


def test_a_name_that_other_commands_use_for_something_else_is_refused_with_the_right_one(irsim: Run) -> None:
    known = dict(every_command())
    for words, names in REFUSED.items():
        own = {name for one in known[words].params for name in one.opts}
        for old, instead in names.items():
            assert old not in own
            assert any(name in own for name in re.findall(r"-{1,2}[a-z-]+", instead))
            for given in (old, f"{old}=3"):
                answer = said(irsim(*words.split(), given, code=2).stderr)
                assert f"irsim {words} has no {old}: {instead}" in answer


def test_every_command_that_writes_a_file_takes_its_name_with_o(irsim: Run, room: Path, tmp_path: Path) -> None:
    for words, command in every_command():
        for one in command.params:
            if one.param_type_name == "argument":
                assert not re.search("[Ff]ile to write", one.help or ""), words
            elif "--out" in one.opts:
                assert "-o" in one.opts, words
    irsim("run", "room.yaml", "--record", code=0)
    before = set(tmp_path.iterdir())
    for wrong in (("replay", "last", "a.html"), ("map", "export", "room.yaml", "a.html", "-o", "b.yaml")):
        answer = said(irsim(*wrong, code=2).stderr)
        assert "a.html is one argument too many; a file to write is named with -o: -o a.html" in answer, answer
    assert "name the file to write with -o: -o a.csv" in irsim("export", "last", "a.csv", code=2).stderr
    assert set(tmp_path.iterdir()) == before
    irsim("replay", "last", "-o", "a.html", code=0)
    assert (tmp_path / "a.html").is_file()


def test_a_tool_of_the_server_is_answered_with_its_command(irsim: Run) -> None:
    assert "The command is: irsim describe robot.behavior" in said(irsim("lookup", "robot.behavior", code=2).stderr)
    assert set(TOOLS.values()) <= set(COMMANDS)
    assert set(TOOLS).isdisjoint(COMMANDS)
    assert "Did you mean 'run'?" in said(irsim("rn", code=2).stderr)


def test_the_help_says_which_seeds_there_are_and_the_message_which_is_the_largest(irsim: Run, room: Path) -> None:
    for words in (["demo"], ["run"], ["train"], ["validate"]):
        shown = irsim(*words, "--help", code=0).stdout
        assert "18446744073709551615" not in shown.replace(" ", "").replace("│", "")
        assert "0 or more" in said(shown)
    for wrong in (-1, 2**64, "1.5", "seven"):
        answer = said(irsim("run", "room.yaml", "--seed", wrong, code=2).stderr)
        assert f"'{wrong}' is not a whole number from 0 to 18446744073709551615" in answer
    assert f"--seed {2**64 - 1}" in irsim("run", "room.yaml", "--seed", 2**64 - 1, code=0).stdout


def test_the_help_is_grouped(irsim: Run) -> None:
    whole = irsim("--help", code=0).stdout
    headings = ["Start", "Scenarios", "Runs", "Comparisons", "Learning", "Other programs"]
    places = [whole.index(f" {heading} ─") for heading in headings]
    assert places == sorted(places)
    for name in ("run", "benchmark"):
        page = irsim(name, "--help", code=0).stdout
        for panel in ("Simulation", "Files", "Output"):
            assert f" {panel} " in page, name


def completed(line: str, folder: Path) -> list[str]:
    """The words that the TAB key offers after a line."""
    words = line.split(" ")
    variables = {"_IRSIM_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)}
    done = subprocess.run(
        [sys.executable, "-m", "irsim"], cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT), **variables},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout.split()


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("irsim run room.yaml --policy orc", "orca"),
        ("irsim benchmark room.yaml --policies dash,orc", "dash,orca"),
        ("irsim describe robot.sensors.lidar2d.range_m", "robot.sensors.lidar2d.range_max"),
        ("irsim describe unknown-sens", "unknown-sensor"),
        ("irsim describe lida", "lidar2d"),
        ("irsim describe vel_m", "vel_max"),
        ("irsim describe corridor_soc", "corridor_social"),
        ("irsim describe task.goal_li", "task.goal_lidar"),
        ("irsim describe passed_thr", "passed_through"),
        ("irsim new corridor-pas", "corridor-passing"),
        ("irsim new corridor-passing --set wid", "width="),
        ("irsim train goal_li", "goal_lidar"),
        ("irsim export last --to mca", "mcap"),
        ("irsim diff-runs last-", "last-1"),
        ("irsim replay roo", "room-"),
        ("irsim bridge page scene.ply --run las", "last"),
        ("irsim render room.yaml --overlays names,clear", "names,clearance"),
    ],
)
def test_the_tab_key_completes_values(line: str, offered: str, irsim: Run, room: Path, tmp_path: Path) -> None:
    if any(word in line for word in ("last", "replay", "page")):
        irsim("run", "room.yaml", "--record", code=0)
        irsim("run", "room.yaml", "--record", code=0)
    assert any(word.startswith(offered) for word in completed(line, tmp_path))


def test_every_kind_of_topic_that_is_offered_is_answered() -> None:
    offer = offers("describe", "topic")
    assert offer is not None
    offered = offer(None, None, "")
    assert len(offered) > 1000
    for topic in ["storage", "host", *random.Random(1).sample(offered, 40)]:
        assert (topic, lookup(topic).read_as) == (topic, None)


def test_last_1_is_the_run_before_the_last(irsim: Run, room: Path) -> None:
    irsim("run", "room.yaml", "--seed", "1", "--record", code=0)
    irsim("run", "room.yaml", "--steps", "5", "--record", code=0)
    assert "5 steps" in irsim("inspect", "last", code=0).stdout or "to 5" in irsim("inspect", "last", code=0).stdout
    assert "step" in irsim("diff-runs", "last-1", "last", code=1).stdout
    assert irsim("diff-runs", code=1).stdout == irsim("diff-runs", "last-1", "last", code=1).stdout
    irsim("diff-runs", "last", code=0)
    irsim("render", "last-1", "-o", "before.png", code=0)
    assert "unknown-run" in irsim("replay", "last-2", code=2).stderr


def test_written_paths_are_printed_in_one_way(irsim: Run, room: Path, tmp_path: Path) -> None:
    irsim("run", "room.yaml", "--record", code=0)
    written = {
        ("new", "corridor-passing"): "corridor-passing.yaml",
        ("render", "room.yaml", "-o", "a.png"): "a.png",
        ("render", "room.yaml", "-o", tmp_path / "b.png"): "b.png",
        ("run", "room.yaml", "--save-gif", "c.gif", "--steps", "2"): "c.gif",
        ("export", "last", "-o", "d.csv"): "d.csv",
        ("replay", "last", "-o", "e.html"): "e.html",
        ("templates", "crossing", "--sheet", "f.png"): "f.png",
        ("schema", "--of", "task", "-o", "g.json"): "g.json",
    }
    for words, name in written.items():
        said = [line for line in irsim(*words, code=0).stdout.splitlines() if line.startswith("wrote ")]
        assert [re.sub(r" \(.*\)$", "", line) for line in said] == [f"wrote {name}"], words
        assert (tmp_path / name).is_file()
    again = irsim("run", "room.yaml", "--save-gif", "c.gif", "--steps", "2", code=0).stdout
    assert re.search(r"^replaced c\.gif \([\d.]+ [kM]B\)$", again, re.MULTILINE)
    kept = {"corridor-passing.yaml", "d.csv"}
    for words, name in written.items():
        before = (tmp_path / name).stat().st_mtime_ns
        if name in kept:
            assert "--force" in irsim(*words, code=2).stderr
            assert (tmp_path / name).stat().st_mtime_ns == before
            words = (*words, "--force")
        shown = irsim(*words, code=0).stdout
        assert re.search(rf"^replaced {re.escape(name)}\b", shown, re.MULTILINE), shown
        assert (tmp_path / name).stat().st_mtime_ns > before


def test_the_demo_replaces_its_film_and_says_so(irsim: Run) -> None:
    for verb in ("wrote", "replaced"):
        assert f"\n{verb} irsim-demo.gif (" in irsim("demo", code=0).stdout


def test_the_help_has_the_rule_for_files_that_exist(irsim: Run) -> None:
    shown = " ".join(irsim("--help", code=0).stdout.split())
    assert "pictures, films, HTML pages and schemas are made again" in shown
    assert "stay as they are unless --force is given" in shown


def test_a_picture_is_told_in_two_lines(irsim: Run, room: Path) -> None:
    short = irsim("render", "room.yaml", "-o", "a.png", code=0).stdout.splitlines()
    assert [line.split()[0] for line in short] == ["wrote", "reproduce:"]
    assert "Objects:" in irsim("render", "room.yaml", "-o", "a.png", "-v", code=0).stdout


def test_names_of_policies_are_whole_in_80_columns(tmp_path: Path) -> None:
    pytest.importorskip("pty")
    code = f"import os, pty\nos.environ['COLUMNS'] = '80'\npty.spawn([{sys.executable!r}, '-m', 'irsim', 'policies'])\n"
    variables = {**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm", "NO_COLOR": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=variables, capture_output=True, text=True, check=True,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert "footprint_orca" in done.stdout
    assert "\N{HORIZONTAL ELLIPSIS}" not in done.stdout
    shown = re.sub(r"\x1b\[[0-9;]*m", "", done.stdout)
    assert max(map(len, shown.partition("a file is a policy")[0].splitlines())) <= 80
