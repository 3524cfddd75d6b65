"""Forged submissions: each is whole, with all hashes right, and an audit names what is forged."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from irsim.api.audit_submission import audit_submission
from irsim.api.benchmark_report import record_episode
from irsim.api.submission import table_of
from irsim.benchmarks import submission as module
from irsim.benchmarks.episode import crowded
from irsim.benchmarks.log import in_order, with_episodes
from irsim.benchmarks.plan import Plan
from irsim.benchmarks.stored import EPISODES, PLAN, RESULTS, measure_plan
from irsim.benchmarks.submission import MANIFEST, ROWS, RUNS, Manifest, sample_seed, sampled_episodes
from irsim.cli.app import app
from irsim.common.hashing import digest, file_digest
from irsim.policies.catalog import open_policy
from irsim.results.audit import SubmissionAudit
from irsim.results.benchmark import CROWDED, EpisodeRow, SuiteResult
from irsim.runs.files import DIGEST_LENGTH

ARGUMENTS = ["benchmark", "clutter_v2", "--policies", "dash,orca", "--scenario", "posts-15", "--protocol", "freeze"]
SCENARIO = "posts-15/freeze"


@pytest.fixture(autouse=True, scope="module")
def small_samples() -> Iterator[None]:
    """Five episodes are recorded, and three are not."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "SAMPLED", 5)
        yield


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory, small_samples: None) -> Path:
    """An honest submission, which no test changes."""
    folder = tmp_path_factory.mktemp("submitted") / "mine"
    done = CliRunner().invoke(app, [*ARGUMENTS, "--seeds", "4", "--submission", str(folder), "--workers", "1"])
    assert done.exit_code == 0, done.output
    return folder


class Forger:
    """A submission that is changed, and then made whole again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.plan = Plan.model_validate_json((folder / PLAN).read_bytes())
        self.result = SuiteResult.model_validate_json((folder / RESULTS).read_bytes())
        self.manifest = Manifest.model_validate_json((folder / MANIFEST).read_bytes())
        self.names = {text: name for name, text in self.plan.policies.items()}

    def key(self, row: EpisodeRow) -> tuple[str, str, int]:
        return row.scenario, self.names[row.behavior], row.seed

    def recorded(self) -> list[EpisodeRow]:
        keys = [(one.scenario, one.policy, one.seed) for one in self.manifest.sample]
        return [row for row in self.result.episodes if self.key(row) in keys]

    def change_rows(self, how: Callable[[EpisodeRow], EpisodeRow | None]) -> None:
        """Change or drop rows; tables follow, and the sample is drawn anew from the rows that are left."""
        rows = [changed for row in self.result.episodes if (changed := how(row)) is not None]
        self.result = with_episodes(self.result, rows)  # type: ignore[assignment]
        places = {(one.scenario, one.policy, one.seed): one for one in self.manifest.sample}
        done = [self.key(row) for row in rows if row.outcome != CROWDED]
        sample = []
        for number, key in enumerate(sampled_episodes(sample_seed(self.plan), done)):
            target = self.folder / "new" / f"{number:02d}"
            if key in places:
                shutil.copytree(self.folder / places[key].folder, target)
            else:
                self.record(key[0], key[1], key[2], target)
            sample.append({"scenario": key[0], "policy": key[1], "seed": key[2], "folder": f"{RUNS}/{number:02d}"})
        shutil.rmtree(self.folder / RUNS)
        (self.folder / "new").rename(self.folder / RUNS)
        data = self.manifest.model_dump() | {"sample": sample, "episodes": len(rows)}
        self.manifest = Manifest.model_validate(data)

    def record(self, scenario: str, policy: str, seed: int, target: Path, text: Callable[[str], str] = str) -> None:
        """Record an episode, of another text if one is given."""
        planned = next(one for one in self.plan.scenarios if one.name == scenario)
        planned = planned.model_copy(update={"text": text(planned.text)})
        assert record_episode(planned, seed, self.plan, open_policy(self.plan.policies[policy]), target)

    def replace_record(self, row: EpisodeRow, *, seed: int, policy: str, text: Callable[[str], str] = str) -> Path:
        """Replace the record of a row by one of another episode, which then calls itself the right one.

        The row gets the numbers of that other episode.
        """
        one = next(each for each in self.manifest.sample if (each.scenario, each.policy, each.seed) == self.key(row))
        place = self.folder / one.folder
        shutil.rmtree(place)
        self.record(one.scenario, policy, seed, place, text)
        planned = next(each for each in self.plan.scenarios if each.name == one.scenario)
        (place / "scenario.yaml").write_text(planned.text, encoding="utf-8")
        edit(
            place / "run.json", lambda data: (data.update(seed=row.seed), data["options"].update(behavior=row.behavior))
        )
        scenarios = [planned.model_copy(update={"text": text(planned.text)})]
        other = {"scenarios": scenarios, "policies": {policy: self.plan.policies[policy]}, "seeds": [seed]}
        [real] = measure_plan(self.plan.model_copy(update=other), workers=1).episodes
        mine = real.model_copy(update={"behavior": row.behavior, "seed": row.seed})
        self.result = with_episodes(  # type: ignore[assignment]
            self.result, [mine if each is row else each for each in self.result.episodes]
        )
        return place

    def sign(self) -> Path:
        """Write everything, with all hashes right."""
        folder = self.folder
        (folder / PLAN).write_text(self.plan.model_dump_json(indent=1) + "\n", encoding="utf-8")
        self.result = self.result.model_copy(update={"hash": self.plan.hash})
        (folder / RESULTS).write_text(self.result.model_dump_json(indent=1) + "\n", encoding="utf-8")
        rows = (*self.result.episodes,)
        log = (folder / EPISODES).read_text(encoding="utf-8")
        head = json.loads(log.partition("\n")[0]) | {"random": self.result.random}
        (folder / EPISODES).write_text(
            json.dumps(head, separators=(",", ":"), ensure_ascii=False) + "\n", encoding="utf-8"
        )
        (folder / EPISODES).write_text(in_order(folder / EPISODES, rows), encoding="utf-8")
        (folder / ROWS).write_text(table_of(self.result, self.names), encoding="utf-8")
        files = [folder / name for name in (PLAN, RESULTS, EPISODES, ROWS)] + sorted((folder / RUNS).glob("*/*"))
        data = self.manifest.model_dump() | {
            "plan_hash": self.plan.hash,
            "policies": {name: digest(text) for name, text in self.plan.policies.items()},
            "files": {file.relative_to(folder).as_posix(): file_digest(file) for file in files},
        }
        (folder / MANIFEST).write_text(json.dumps(data), encoding="utf-8")
        return folder


@pytest.fixture
def forger(honest: Path, tmp_path: Path) -> Forger:
    """A copy of the honest submission in other hands."""
    return Forger(Path(shutil.copytree(honest, tmp_path / "forged")))


def edit(path: Path, how: Callable[[Any], Any]) -> None:
    """Change a JSON file."""
    data = json.loads(path.read_text(encoding="utf-8"))
    how(data)
    path.write_text(json.dumps(data), encoding="utf-8")


def better(row: EpisodeRow) -> EpisodeRow:
    """The row of a failed episode, made a success."""
    metrics = {**row.metrics, "success": 1.0, "goal_reached": 1.0, "collision": 0.0, "timeout": 0.0}
    return row.model_copy(update={"outcome": "success", "failures": {}, "metrics": metrics})


def causes(result: SubmissionAudit) -> str:
    """All problems as text."""
    return "\n".join(f"{one.code}: {one.path}: {one.message}" for one in result.problems)


def failed(rows: Sequence[EpisodeRow]) -> list[EpisodeRow]:
    """The episodes without success."""
    return [row for row in rows if row.outcome != "success"]


@pytest.mark.parametrize("replay", [None, "all"])
def test_an_honest_submission_passes(honest: Path, replay: Any) -> None:
    result = audit_submission(honest, replay=replay, workers=1)
    assert result.equal, causes(result)
    assert (result.episodes, result.sampled, result.replayed) == (8, 5, 0 if replay is None else 8)
    assert result.unchecked == (3 if replay is None else 0)
    assert result.not_replayed == result.notes == []


def test_a_whole_forgery_without_changes_passes(forger: Forger) -> None:
    """The forger writes files as the honest author does, so that the audit finds the forgery and no slip."""
    forger.change_rows(lambda row: row)
    result = audit_submission(forger.sign(), replay="all", workers=1)
    assert result.equal, causes(result)


def easier(text: str) -> str:
    """The scene with its posts at one side."""
    assert "range_high" in text
    lines = text.split("\n")
    at = next(number for number, line in enumerate(lines) if "range_high" in line)
    indent = lines[at + 1][: len(lines[at + 1]) - len(lines[at + 1].lstrip())]
    lines[at + 1] = f"{indent}- 1.5"
    return "\n".join(lines)


def of_another_scene(forger: Forger) -> None:
    row = forger.recorded()[0]
    forger.replace_record(row, seed=row.seed, policy=forger.names[row.behavior], text=easier)


def of_another_seed(forger: Forger) -> None:
    row = forger.recorded()[0]
    forger.replace_record(row, seed=7, policy=forger.names[row.behavior])


def of_another_policy(forger: Forger) -> None:
    row = failed(forger.recorded())[0]
    forger.replace_record(row, seed=row.seed, policy="orca")


def failures_without_room(forger: Forger) -> None:
    nothing = crowded()
    metrics = dict.fromkeys(nothing.pop("metrics"))
    gone = {key: value for key, value in nothing.items() if key != "robots"} | {"metrics": metrics}
    forger.change_rows(lambda row: row if row.outcome == "success" else row.model_copy(update=gone))


def nothing_random(forger: Forger) -> None:
    forger.result = forger.result.model_copy(update={"random": {SCENARIO: []}})
    forger.change_rows(lambda row: row if row.seed == forger.plan.seeds[0] else None)


def another_plan(forger: Forger) -> None:
    """One of 400 equivalent plans: with a policy that drives no robot."""
    forger.plan = forger.plan.model_copy(update={"company": {"spare": "{name: dash, angle_tolerance: 0.123}"}})


STATIC = {
    of_another_scene: "submission-origin: runs/0?: its scene is not the one of the scenario and the seed",
    of_another_seed: "submission-origin: runs/0?: its scene is not the one of the scenario and the seed",
    of_another_policy: "its scene is not the one of the scenario and the seed: options[0].behavior",
    failures_without_room: "is called placement-crowded, and there is room for all objects",
    nothing_random: "submission-rows: results.json: its key random does not follow from the suite",
    another_plan: "it is not what irsim plans for this suite; different: company",
}


@pytest.mark.parametrize("forge", STATIC, ids=lambda forge: forge.__name__)
def test_a_forgery_is_named_without_running_anything_again(forge: Callable[[Forger], None], forger: Forger) -> None:
    forge(forger)
    result = audit_submission(forger.sign())
    assert not result.equal
    place = next(iter({one.path for one in result.problems if one.path.startswith(RUNS)}), "")
    assert STATIC[forge].replace("runs/0?", place) in causes(result)


@pytest.mark.parametrize("metric", ["spl", "restricted_time", "collision_count", "acceleration_max"])
def test_each_metric_of_a_row_must_follow_from_its_record(metric: str, forger: Forger) -> None:
    chosen = forger.key(forger.recorded()[0])

    def changed(row: EpisodeRow) -> EpisodeRow:
        metrics = {**row.metrics, metric: (row.metrics[metric] or 0.0) + 0.01}
        return row.model_copy(update={"metrics": metrics}) if forger.key(row) == chosen else row

    forger.change_rows(changed)
    [problem] = audit_submission(forger.sign()).problems
    where = f"{chosen[0]}, {chosen[1]}, seed {chosen[2]}"
    assert problem.code == "submission-run"
    assert problem.message == f"metrics {metric} of the row of {where} differ from the record"


def test_rows_outside_of_the_sample_are_run_again(forger: Forger) -> None:
    recorded = {forger.key(row) for row in forger.recorded()}
    odd = [forger.key(row) for row in failed(forger.result.episodes) if forger.key(row) not in recorded]
    assert odd
    forger.change_rows(lambda row: better(row) if forger.key(row) in odd else row)
    folder = forger.sign()
    assert audit_submission(folder).equal  # files alone cannot show it
    result = audit_submission(folder, replay="all", workers=1)
    listed = [one for one in result.problems if one.code == "submission-replay"]
    assert len(listed) == len(odd)
    assert (listed[0].given, listed[0].allowed) == ("success", "collision")
    assert "outcome and" in listed[0].message


def test_a_record_of_another_policy_that_hides_it_is_run_again(forger: Forger) -> None:
    row = failed(forger.recorded())[0]
    place = forger.replace_record(row, seed=row.seed, policy="orca")
    honest = forger.folder / "honest"
    forger.record(row.scenario, "dash", row.seed, honest)
    text = (honest / "resolved.json").read_text(encoding="utf-8")
    shutil.rmtree(honest)
    (place / "resolved.json").write_text(text, encoding="utf-8")
    edit(place / "run.json", lambda data: data.update(resolved=digest(text)[:DIGEST_LENGTH]))
    folder = forger.sign()
    assert audit_submission(folder).equal  # files alone do not show who drove
    result = audit_submission(folder, replay="all", workers=1)
    where = place.relative_to(folder).as_posix()
    assert {(one.code, one.path) for one in result.problems} == {
        ("submission-replay", RESULTS),
        ("submission-replay", where),
    }


def test_the_order_of_a_plan_does_not_choose_the_sample(forger: Forger) -> None:
    plan = forger.plan
    swapped = plan.model_copy(update={"policies": dict(reversed(plan.policies.items())), "seeds": plan.seeds[::-1]})
    assert swapped.hash != plan.hash
    assert sample_seed(swapped) == sample_seed(plan)
    assert sample_seed(plan.model_copy(update={"seeds": plan.seeds[:-1]})) != sample_seed(plan)


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        ({"policies": {"dash": "dash", "orca": "{name: orca, safe_radius: 0.06}"}}, "the policy orca is another one"),
        ({"seeds": [100001, 100000, 100002, 100003]}, "its seeds are not in order"),
        ({"imports": ["antigravity"]}, "different: imports"),
        ({"reproduce": "irsim benchmark clutter_v2; rm -rf ."}, "the command that reproduces it is not one of irsim"),
    ],
)
def test_another_plan_is_named(change: dict[str, Any], cause: str, forger: Forger) -> None:
    forger.plan = forger.plan.model_copy(update=change)
    assert cause in causes(audit_submission(forger.sign()))


def test_the_salt_draws_the_same_episodes_again(honest: Path) -> None:
    first = audit_submission(honest, replay=2, workers=1)
    again = audit_submission(honest, replay=2, salt=first.salt, workers=1)
    assert first.salt in first.summary
    assert [row.replayed for row in first.leaderboard] == [row.replayed for row in again.leaderboard]
    assert first.salt != audit_submission(honest, replay=1, workers=1).salt


def test_another_engine_is_said(honest: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.api.audit_submission.engine", lambda: "0123456789ab")
    result = audit_submission(honest)
    assert result.equal
    assert f"it was run by engine {result.engine}, and this is engine 0123456789ab" in result.summary
