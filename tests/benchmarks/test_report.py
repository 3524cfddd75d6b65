"""Terminal, page and tables of a benchmark: summaries by protocol, zones, facts of a suite, assumptions."""

from __future__ import annotations

import csv
import json
import re
import shlex
from html import unescape
from pathlib import Path

import pytest
from PIL import Image
from rich.console import Console
from typer.testing import CliRunner

from irsim.api.benchmark_report import MARKDOWN, PAGE, REPLAYS, write_report
from irsim.benchmarks.comparison import benchmark
from irsim.benchmarks.report.charts import charts
from irsim.benchmarks.report.markdown import markdown
from irsim.benchmarks.report.page import page
from irsim.benchmarks.report.rows import worst_episodes
from irsim.benchmarks.stored import RESULTS, measure_plan, run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.cli.app import app
from irsim.cli.benchmark import show_benchmark
from irsim.cli.output import progress
from irsim.results.benchmark import SuiteResult
from irsim.simulation.engine import engine

SUITE = """
suite: small
version: 3
title: Robots in a square
about: Two sizes of a group that crosses a door.
sources: ["A. Author: Doors, 2020"]
scenarios:
  - name: square
    vary: {"robot[0].number": [2, 3]}
    scenario:
      world: {width: 6, height: 6, zones: [{name: door, line: [[3, 0], [3, 6]]}]}
      robot:
        - {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, distribution: {name: random}}
seeds: {first: 5, count: 2}
steps: 30
until: first_collision
protocols: [freeze, yield]
policies: {orca: {name: orca, timeHorizon: 2}, dash: dash}
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, SuiteResult]:
    """A folder with the report of a small suite, beside it the table that the command prints, and the result."""
    place = tmp_path_factory.mktemp("report")
    (place / "small.yaml").write_text(SUITE, encoding="utf-8")
    words = ["benchmark", str(place / "small.yaml"), "--csv", "-o", str(place / "run"), "--workers", "1"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    (place / "table.csv").write_text(done.stdout, encoding="utf-8")
    return place / "run", SuiteResult.model_validate_json((place / "run" / RESULTS).read_bytes())


def shown(result: SuiteResult, *, verbose: bool = True) -> str:
    """The table as it is printed into a file."""
    out = Console(width=140, force_terminal=False, markup=False, highlight=False)
    with out.capture() as capture:
        show_benchmark(result, out, verbose=verbose)
    return capture.get()


def test_each_protocol_is_summarised_on_its_own(made: tuple[Path, SuiteResult]) -> None:
    place, result = made
    summaries = [row for row in result.rows if row.scenario.startswith("(all)")]
    names = [(row.scenario, row.episodes) for row in summaries]
    assert names == [("(all)/freeze", 4)] * 2 + [("(all)/yield", 4)] * 2  # 2 scenarios with 2 seeds
    assert [row.paired["success"].n for row in summaries if row.paired] == [4, 4]
    for row in summaries:
        protocol = row.scenario.partition("/")[2]
        own = [r for r in result.rows if r.scenario.endswith(f"-2/{protocol}") or r.scenario.endswith(f"-3/{protocol}")]
        assert row.timeout.count == sum(r.timeout.count for r in own if r.behavior == row.behavior)
    text, table, page = shown(result), (place / MARKDOWN).read_text("utf-8"), (place / PAGE).read_text("utf-8")
    for protocol in ("freeze", "yield"):
        assert f"\n(all)/{protocol}: dash minus orca, same seeds: " in text
        assert f"| (all)/{protocol} | dash | 4 |" in table
        assert f"<td>(all)/{protocol}</td>" in page
    assert "| (all) |" not in table


def test_charts_of_all_episodes_are_of_one_protocol(made: tuple[Path, SuiteResult]) -> None:
    captions = [caption for caption, _ in charts(made[1]) if caption.startswith("Episodes of all scenarios")]
    assert len(captions) >= 2
    assert all("under the protocol freeze: " in text or "under the protocol yield: " in text for text in captions)


def test_a_suite_prints_few_lines_of_failures(made: tuple[Path, SuiteResult]) -> None:
    lines = [line for line in shown(made[1]).splitlines() if line.startswith("failed: ")]
    count = sum(bool(row.failed) for row in made[1].rows)
    assert (count > 5, len(lines)) == (True, 6)
    assert f"failed: {count - 5} more rows; rates are in results.md, seeds in results.json" == lines[-1]


def test_a_suite_ends_with_what_decides_unless_all_details_are_asked_for(made: tuple[Path, SuiteResult]) -> None:
    brief, whole = shown(made[1], verbose=False).splitlines(), shown(made[1]).splitlines()
    count = sum(bool(row.failed) for row in made[1].rows)
    assert not any(line.startswith(("failed:", "note:", "metrics are")) for line in brief)
    assert any(line.startswith(f"{count} of {len(made[1].rows)} rows have failed episodes; -v") for line in brief)
    assert brief[-1] == whole[-1] == f"reproduce: {made[1].reproduce}"
    assert len([line for line in brief if line not in whole]) == 1


def test_csv_of_a_suite_names_policy_family_protocol_and_values(made: tuple[Path, SuiteResult]) -> None:
    with made[0].with_name("table.csv").open(encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    assert len(rows) == len(made[1].episodes)
    row = next(row for row in rows if row["scenario"] == "square-3/yield" and row["behavior"] == "dash")
    cells = [row[key] for key in ("policy", "family", "protocol", "values.robot[0].number")]
    assert cells == ["dash", "square", "yield", "3"]
    assert {row["policy"] for row in rows} == {"orca", "dash"}


def test_one_protocol_needs_no_name(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SUITE, encoding="utf-8")
    plan = suite_plan(str(tmp_path / "small.yaml"), protocols=["yield"], seeds=2, policies=["dash"])
    assert run_plan(plan, tmp_path / "run", workers=1).rows[-1].scenario == "(all)"


def test_tables_of_zones_and_differences_and_what_the_suite_says(made: tuple[Path, SuiteResult]) -> None:
    place, _ = made
    text, html = (place / MARKDOWN).read_text(encoding="utf-8"), (place / PAGE).read_text(encoding="utf-8")
    failed = sum(one.outcome != "success" for one in made[1].episodes)
    in_both = (
        "Two sizes of a group that crosses a door.",
        "Sources: A. Author: Doors, 2020",
        "The horizon is 3 s; an episode ends with the first collision.",
        "crossings of zones",
    )
    in_text = (
        "| scenario | policy | zone | zone_crossings |",
        "| square-2/freeze | orca | door | ",
        "Differences to orca with the same seeds:",
        "| square-2/freeze | dash | 2 | ",
    )
    assert [part for part in (*in_both, *in_text) if part not in text] == []
    in_page = ("<h2>Zones</h2>", f"<p>4 of {failed} are shown.</p>")
    assert [part for part in (*in_both, *in_page) if part not in html] == []
    assert "human [m]" not in text + html  # there are no people


def test_the_page_begins_with_all_scenarios_and_has_words_for_people(made: tuple[Path, SuiteResult]) -> None:
    html = (made[0] / PAGE).read_text(encoding="utf-8")
    first = re.search(r"<tbody><tr[^>]*><td>([^<]*)</td>", html)
    assert first
    assert first[1] == "(all)/freeze"
    assert "2 seeds from 5" in html
    one = made[1].model_copy(update={"seeds": [5], "about": "Robots cross a door (`world.zones`)."})
    assert "1 seed from 5" in page(one)
    assert "<code>world.zones</code>" in page(one)
    assert "`" not in page(one).partition("<script>")[0]


def test_a_failed_episode_comes_with_the_command_that_records_it_again(
    made: tuple[Path, SuiteResult], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    html = (made[0] / PAGE).read_text(encoding="utf-8")
    commands = [shlex.split(unescape(text)) for text in re.findall(r"<pre>(irsim run .*?)</pre>", html)]
    assert len(commands) == len(worst_episodes(made[1]))
    for words, episode in zip(commands, worst_episodes(made[1]), strict=True):
        done = CliRunner().invoke(app, [*words[1:], "--json"])
        assert done.exit_code == 0, done.output
        again = json.loads(done.stdout)
        assert (again["outcome"], again["steps"]) == (episode.outcome, episode.steps)
        assert again["run_id"]


def test_a_scenario_with_a_picture_as_map_has_replays(tmp_path: Path) -> None:
    (tmp_path / "suites").mkdir()
    Image.new("L", (20, 20), 255).save(tmp_path / "hall.png")
    scene = "world: {width: 5, height: 5, obstacle_map: ../hall.png}\nrobot: {goal: [4, 4, 0]}\n"
    (tmp_path / "suites" / "hall.yaml").write_text(scene, encoding="utf-8")
    suite = """
suite: halls
version: 1
title: One hall
scenarios: [{name: hall, file: hall.yaml}]
steps: 3
policies: {dash: dash}
"""
    (tmp_path / "suites" / "halls.yaml").write_text(suite, encoding="utf-8")
    plan = suite_plan(str(tmp_path / "suites" / "halls.yaml"), seeds=1)
    report = write_report(run_plan(plan, tmp_path / "run", workers=1), tmp_path / "run")
    assert not [note for note in report.notes if "replay" in note]
    [replay] = (tmp_path / "run" / REPLAYS).iterdir()
    assert f'href="{REPLAYS}/{replay.name}"' in report.page.read_text(encoding="utf-8")


def test_without_a_terminal_progress_is_a_line_from_time_to_time(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [0.0]
    monkeypatch.setattr("irsim.cli.output.time.monotonic", lambda: now[0])
    with progress("simulating") as report:
        for done in range(100):
            now[0] = float(done)
            report(done, 1000)
    assert capsys.readouterr().err.splitlines() == [f"simulating: {done} of 1,000" for done in (30, 60, 90)]


SCENE = "robot: {state: [1, 1], goal: [2, 1], behavior: {name: dash}}\n"


@pytest.mark.usefixtures("workspace")
def test_without_the_library_terminal_and_report_say_how_to_get_the_table(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.benchmarks.report.table.find_spec", lambda name: None)
    Path("a.yaml").write_text(SCENE, encoding="utf-8")
    done = CliRunner().invoke(app, ["benchmark", "a.yaml", "-o", "run"])
    assert done.exit_code == 0
    line = "results.parquet was not written: pyarrow is not installed (pip install 'irsim-mcp[records]')"
    assert f"note: {line}" in done.stderr.splitlines()
    assert f"Note: {line}" in Path("run/results.md").read_text(encoding="utf-8")
    assert not Path("run/results.parquet").exists()


ARRIVES = "robot:\n  - {state: [1, 1], goal: [2, 1], kinematics: {name: diff}, behavior: {name: dash}}\n"
STANDS = "  - {state: [5, 5], goal: [9, 5], kinematics: {name: diff}}\n"


@pytest.mark.usefixtures("workspace")
def test_times_beside_failures_are_those_of_robots_that_arrived() -> None:
    told = {}
    for name, text in (("all", ARRIVES), ("one", ARRIVES + STANDS)):
        Path(f"{name}.yaml").write_text(text, encoding="utf-8")
        told[name] = CliRunner().invoke(app, ["benchmark", f"{name}.yaml"]).stdout
    assert "time: of the robots that arrived, in any episode" in told["one"]
    assert "of the robots that arrived" not in told["all"]


NAMES = ("$\\frac{$ <img src=x onerror=alert(1)>", "=1+1 \u202e](http://evil)")


def test_names_are_text_in_charts_tables_and_pages(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(ARRIVES, encoding="utf-8")
    result = benchmark(dict.fromkeys(NAMES, file), behaviors=["dash", "orca"], seeds=2, workers=1)
    assert sum("$" in svg for _, svg in charts(result)) == 1
    report = markdown(result).partition("Reproduce: `")[0]  # what follows is code
    for shown in (report, page(result)):
        assert "<img" not in shown
        assert "\u202e" not in shown
    assert "](http" not in report
    assert "Content-Security-Policy" in page(result)


ROBOT = "{kinematics: {name: diff}, state: [1, 1, 0], goal: [3, 2, 0], behavior: {name: dash}%s}"


def assumed(folder: Path, **scenes: tuple[str, str]) -> str:
    """Assumptions in the report of some scenes; (keys of the world, keys of the robot) by name."""
    texts = {
        name: f"world: {{width: 5, height: 5{world}}}\nrobot:\n  - {ROBOT % robot}\n"
        for name, (world, robot) in scenes.items()
    }
    files = {name: folder / f"{name}.yaml" for name in texts}
    for name, text in texts.items():
        files[name].write_text(text, encoding="utf-8")
    report = markdown(benchmark(files, seeds=1, workers=1))
    line, *others = [line for line in report.splitlines() if line.startswith("Taken for granted: ")]
    assert not others
    return line.removeprefix("Taken for granted: ").rstrip()


def test_what_is_taken_for_granted_is_said_and_scenes_that_differ_are_named(tmp_path: Path) -> None:
    assert assumed(tmp_path, plain=(", step_time: 0.2", "")) == (  # as in 2.12
        "contacts count at the ends of steps of 0.2 s only; robots change their speed at once (no acce); "
        "what policies know, they know exactly and at once."
    )
    real = assumed(tmp_path, real=(", contacts: swept", ", acce: [1, 2]"))
    assert real.startswith("contacts within steps count, too; accelerations are limited; ")
    mixed = assumed(tmp_path, a=("", ""), b=(", contacts: swept", ""), c=("", ""))
    assert mixed.startswith(
        "in a, c contacts count at the ends of steps of 0.1 s only, in b contacts within steps count, too; robots "
    )


def test_a_report_ends_with_the_line_that_cites_it(tmp_path: Path) -> None:
    suite = measure_plan(suite_plan("circle_swap_v1", policies=["dash"], seeds=2, scenarios=["diff-4"]), workers=1)
    assert isinstance(suite, SuiteResult)
    line = f"suite circle_swap_v1, version {suite.suite_version}, suite hash {suite.suite_hash}, run hash {suite.hash}"
    for told in (markdown(suite), page(suite)):
        assert f"irsim {suite.version} (MIT), engine {engine()}, {line}, 2 seeds from " in told.replace("\\", "")
        assert f"irsim {suite.version}, engine {engine()}" in told
    older = suite.model_copy(update={"engine": ""})
    assert "engine" not in markdown(older)  # of a result from before engines had an identity
