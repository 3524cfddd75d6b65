"""The skill ``irsim-benchmark``: commands run, examples end as they state, what it says of intervals is so."""

from __future__ import annotations

import asyncio
import json
import re
import runpy
import shlex
from pathlib import Path
from typing import Any

import pytest
import yaml

import irsim
from irsim.benchmarks.suite_plan import suite_plan
from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.metrics.statistics import wilson
from tests.skills.conftest import ROOT, commands, execute, fences, parts, read, script, spans
from tests.skills.test_skill import SKELETON, tool_arguments

SKILL = ROOT / "skills" / "irsim-benchmark"
POSTS, DENSITY = (SKILL / "examples" / name for name in ("posts", "density"))
VERDICT = SKILL / "scripts" / "verdict.py"
_, BODY = parts(SKILL / "SKILL.md")


def verdict(path: Path, *words: str) -> tuple[int, dict[str, Any]]:
    return script(VERDICT, str(path), *words, alone=True)


def shares(row: dict[str, Any]) -> str:
    success = row["success"]
    return f"{100 * success['rate']:.0f} % [{100 * success['low']:.0f}, {100 * success['high']:.0f}]"


@pytest.mark.slow(10)
def test_commands_work_as_written(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.yaml").write_text(SKELETON, encoding="utf-8")
    told = [span for span in spans(BODY) if span.startswith("irsim ") and ".yaml" in span]
    assert len(told) >= 4
    for command in told:
        output = execute(shlex.split(command), tmp_path)
        if command.endswith("--json"):
            (tmp_path / "result.json").write_text(output, encoding="utf-8")
    [command] = [span for span in spans(BODY) if span.startswith("python ")]
    assert command == "python scripts/verdict.py result.json"
    code, answer = verdict(tmp_path / "result.json")
    assert (code, "one behavior only" in answer["said"]) == (2, True)


def test_tools_and_their_arguments_are_those_of_the_server(tmp_path: Path) -> None:
    tools = asyncio.run(tool_arguments(tmp_path))
    assert {"scenarios", "policies", "seeds", "max_steps"} <= tools["benchmark"]
    assert "job_id" in tools["get_job"]
    assert "seed" in tools["run_episode"]


def test_a_seed_begins_alike_with_more_people() -> None:
    few, many = (irsim.batch(DENSITY / f"crowd-{count}.yaml", 1, seeds=[3]).pose[0].copy() for count in (10, 20))
    assert len(many) == len(few) + 10
    assert (few == many[: len(few)]).all()


def test_metrics_it_names_are_defined() -> None:
    known = {metric.key for metric in (*METRICS, *EPISODE_METRICS)}
    named = {span for span in spans(BODY) if re.fullmatch(r"[a-z]+(_[a-z]+)+", span)} & {
        *("arrived_share", "contacts_per_hour", "time_to_goal", "path_length", "distance_to_human_min"),
        *("personal_space_intrusion_ratio", "space_compliance"),
    }
    assert len(named) == 7
    assert named | {"spl", "success", "collision_count", "timeout"} <= known


def test_the_table_of_seeds_is_wilsons() -> None:
    rows = re.findall(r"^\| (\d+) \| (\d+) to (\d+) % \| ([\d.]+) % \|$", BODY, re.MULTILINE)
    assert [row[0] for row in rows] == ["10", "30", "100", "400"]
    for count, low, high, most in rows:
        n = int(count)
        assert [round(100 * end) for end in wilson(n // 2, n)] == [int(low), int(high)]
        assert 100 * wilson(0, n)[1] == pytest.approx(float(most), abs=0.5 if float(most) > 10 else 0.06)
    assert [round(100 * end) for end in wilson(7, 10)] == [40, 89]


def test_the_cost_of_suites_on_a_cluster_is_that_of_their_episodes() -> None:
    page = (SKILL / "references" / "cluster.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| ([\d.]+) \| ([\d.]+) \| ([\d,]+) \| ([\d.]+) \|$", page, re.MULTILINE)
    assert len(rows) >= 5
    for name, seconds, hours, episodes, total in rows:
        plan = suite_plan(name, full=True)
        count = len(plan.scenarios) * len(plan.policies) * len(plan.seeds)
        assert int(episodes.replace(",", "")) == count
        assert float(hours) == pytest.approx(1000 * float(seconds) / 3600, abs=6e-4)
        assert float(total) == pytest.approx(count * float(seconds) / 3600, abs=6e-3)


def test_options_on_the_page_about_clusters_exist() -> None:
    page = (SKILL / "references" / "cluster.md").read_text(encoding="utf-8")
    known = execute(["irsim", "benchmark", "--help"], ROOT)
    lines = [line.partition("irsim benchmark")[2] for line in page.splitlines() if "irsim benchmark" in line]
    options = {word for line in lines for word in re.findall(r"--[a-z]+", line)}
    assert {"--cluster", "--resume", "--full"} <= options
    assert [option for option in options if option not in known] == []


def test_the_example_of_what_to_say_is_the_one_of_the_examples() -> None:
    [told] = fences(BODY, "text")
    assert "97 % [88, 100] against 43 % [15, 70]" in told
    assert "[-77, -30]" in told


def test_two_behaviors_that_cannot_be_told_apart(tmp_path: Path) -> None:
    [words] = commands(POSTS)
    output = execute(words, POSTS)
    result = json.loads(output)
    (tmp_path / "result.json").write_text(output, encoding="utf-8")
    code, told = verdict(tmp_path / "result.json", "--metric", "success", "--metric", "time_to_goal")
    assert code == 1
    success, time = told["differences"]
    page, reply = read(POSTS, "elements.md"), read(POSTS, "reply.md")
    numbers = f"{success['difference']:.2f} [{success['low']:.2f}, {success['high']:.2f}]"
    assert f"Success is **{success['verdict']}**: {numbers}, about {success['pairs_needed']} pairs" in page
    numbers = f"{time['difference']:+.2f} s [{time['low']:.2f}, {time['high']:.2f}]"
    assert f"Time is **{time['verdict']}** for RVO: {numbers}" in page
    assert f"ORCA {shares(result['rows'][0])}, RVO {shares(result['rows'][1])}" in reply
    assert f"(RVO {result['rows'][1]['collision']['count']} of 30)" in reply
    failed = irsim.run(POSTS / "scenario.yaml", seed=0)
    assert (failed.outcome, failed.sim_time) == ("timeout", pytest.approx(40.0))


@pytest.mark.slow(8)
def test_success_over_density(tmp_path: Path) -> None:
    *filling, words = commands(DENSITY)
    for command in filling:
        execute(command, tmp_path)
        name = command[-1]
        made = yaml.safe_load((tmp_path / name).read_text(encoding="utf-8"))
        kept = yaml.safe_load((DENSITY / name).read_text(encoding="utf-8"))
        made["world"].pop("plot")
        kept["world"].pop("plot")
        assert made == kept
    output = execute(words, DENSITY)
    result = json.loads(output)
    page, reply = read(DENSITY, "elements.md"), read(DENSITY, "reply.md")
    for orca, sfm in zip(result["rows"][0:6:2], result["rows"][1:6:2], strict=True):
        people = re.search(r"\d+", orca["scenario"])
        assert people
        assert f"| {people[0]} | {shares(orca)} | {shares(sfm)} |" in page
        assert shares(orca) in reply
        assert shares(sfm) in reply
    (tmp_path / "result.json").write_text(output, encoding="utf-8")
    code, told = verdict(tmp_path / "result.json")
    assert code == 0
    assert {answer["verdict"] for answer in told["differences"]} == {"worse"}
    last = told["differences"][-1]
    assert f"**{last['difference']:.2f}** [{last['low']:.2f}, {last['high']:.2f}]" in page
    together = result["rows"][6:]
    assert f"success {shares(together[0])} against {shares(together[1])}" in " ".join(BODY.split())
    arrived = [row["metrics"]["time_to_goal"]["n"] for row in together]
    assert f"({arrived[0]} against {arrived[1]} episodes)" in BODY
    assert together[1]["timeout"]["count"] == 0


def row(
    behavior: str, count: int, n: int, differences: tuple[float, float | None, float | None] | None
) -> dict[str, Any]:
    low, high = wilson(count, n)
    paired = {}
    if differences is not None:
        mean, least, most = differences
        paired = {"success": {"n": n, "mean": mean, "std": 0.1, "low": least, "high": most}}
    share = {"count": count, "n": n, "rate": count / n, "low": low, "high": high}
    return {"scenario": "a.yaml", "behavior": behavior, "success": share, "paired": paired}


@pytest.mark.parametrize(
    ("counts", "n", "difference", "said"),
    [
        ((9, 20), 20, (0.55, 0.3, 0.8), "better"),
        ((20, 9), 20, (-0.55, -0.8, -0.3), "worse"),
        ((10, 11), 20, (0.05, -0.2, 0.3), "open"),
        ((3, 5), 5, (0.4, 0.1, 0.8), "open"),  # too few
        ((20, 20), 20, (0.0, -0.16, 0.16), "open"),  # all alike
        ((1, 1), 1, (0.0, None, None), "open"),  # nothing random
    ],
)
def test_verdicts(tmp_path: Path, counts: tuple[int, int], n: int, difference: Any, said: str) -> None:
    path = tmp_path / "result.json"
    rows = [row("one", counts[0], n, None), row("two", counts[1], n, difference)]
    path.write_text(json.dumps({"behaviors": ["one", "two"], "rows": rows, "notes": []}), encoding="utf-8")
    code, told = verdict(path)
    [answer] = told["differences"]
    assert (answer["verdict"], code) == (said, 1 if said == "open" else 0)


def test_verdicts_name_the_policies_of_a_suite(tmp_path: Path) -> None:
    policies = {"one": "{name: orca, timeHorizon: 2}", "two": "dash"}
    first, second = policies.values()
    rows = [row(first, 9, 20, None), row(second, 20, 20, (0.55, 0.3, 0.8))]
    text = json.dumps({"behaviors": [first, second], "policies": policies, "rows": rows, "notes": []})
    (tmp_path / "results.json").write_text(text, encoding="utf-8")
    [answer] = verdict(tmp_path / "results.json")[1]["differences"]
    assert (answer["behavior"], answer["against"], answer["verdict"]) == ("two", "one", "better")


def test_all_pairs_are_corrected_for_their_number_and_can_be_chosen(tmp_path: Path) -> None:
    def pair(one: str, other: str, difference: tuple[float, float, float], p: float | None) -> dict[str, Any]:
        mean, low, high = difference
        estimate = {"n": 20, "mean": mean, "low": low, "high": high}
        known = {"scenario": "hall", "only_behavior": 6, "only_against": 0}
        return {**known, "behavior": one, "against": other, "difference": estimate, "p": p}

    pairs = [
        pair("a", "b", (0.3, 0.1, 0.5), 0.03),  # real alone, not among three
        pair("a", "c", (0.8, 0.5, 0.9), 0.0001),
        pair("b", "c", (0.0, -0.2, 0.2), 1.0),
    ]
    told = {"behaviors": ["a", "b", "c"], "rows": [row("a", 9, 20, None)], "pairs": pairs, "notes": []}
    path = tmp_path / "result.json"
    path.write_text(json.dumps(told), encoding="utf-8")
    code, answer = verdict(path, "--all-pairs")
    assert [one["verdict"] for one in answer["differences"]] == ["open", "better", "open"]
    assert [one["p_corrected"] for one in answer["differences"]] == pytest.approx([0.06, 0.0003, 1.0])
    assert code == 1
    code, answer = verdict(path, "--all-pairs", "--policy", "c", "--verdict", "better")
    assert ([one["behavior"] for one in answer["differences"]], answer["comparisons"]) == (["a"], 2)
    assert verdict(path, "--all-pairs", "--scenario", "yard")[0] == 2


def test_the_script_knows_what_is_better_without_irsim() -> None:
    script = runpy.run_path(str(VERDICT))
    known = (*METRICS, *EPISODE_METRICS)
    better = {metric.key: metric.better for metric in known}
    assert script["BETTER"] == better, f"change MORE, LESS or EITHER in {VERDICT}"
    assert set(script["SHARES"]) == {metric.key for metric in known if metric.unit == "0/1"}
