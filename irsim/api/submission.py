"""Writes a submission: the result of a suite, a sample of its episodes as recorded runs, and a manifest with hashes."""

from __future__ import annotations

import csv
import io
import json
import os
import shutil
from pathlib import Path

from irsim.api.benchmark_report import record_episode
from irsim.benchmarks.plan import Plan
from irsim.benchmarks.policies import label_of
from irsim.benchmarks.roles import shared_with
from irsim.benchmarks.stored import EPISODES, PLAN, RESULTS, read_plan
from irsim.benchmarks.submission import (
    MANIFEST,
    POLICIES,
    ROWS,
    RUNS,
    SampledEpisode,
    manifest_of,
    policy_file,
    sample_seed,
    sampled_episodes,
)
from irsim.benchmarks.summary import KEYS
from irsim.common.files import code_of, write_atomically
from irsim.common.text import cell
from irsim.diagnostics.errors import InputError
from irsim.policies.catalog import file_of
from irsim.results.benchmark import CROWDED, BenchmarkResult
from irsim.runs.files import RunError

__all__ = ["table_of", "write_submission"]

_COLUMNS = ("scenario", "seed", "outcome", "steps", "sim_time", "time_limit", "unreachable")


def write_submission(result: BenchmarkResult, folder: Path) -> Path:
    """Add rows, recorded episodes and the manifest to the folder in which a suite was run.

    Args:
        result: The result.
        folder: Folder in which :func:`irsim.benchmarks.stored.run_plan` has run it.

    Returns:
        The manifest.

    Raises:
        InputError: It is not the result of a suite.
        RunError: The folder cannot be written, or an episode cannot be recorded.
    """
    plan = read_plan(folder)
    if plan.suite is None:
        raise InputError("only a suite can be submitted", "name a suite; irsim suites lists them")
    names = {text: name for name, text in plan.policies.items()}
    done = [(one.scenario, names[one.behavior], one.seed) for one in result.episodes if one.outcome != CROWDED]
    try:
        write_atomically(folder / ROWS, table_of(result, names))
        sample = _record(plan, folder, sampled_episodes(sample_seed(plan), done))
        files = [PLAN, EPISODES, RESULTS, ROWS, *_copy_policies(plan, folder)]
        for one in sample:
            files += [f"{one.folder}/{name}" for name in sorted(os.listdir(folder / one.folder))]
        manifest = manifest_of(plan, folder, len(result.episodes), sample, files)
        write_atomically(folder / MANIFEST, json.dumps(manifest.model_dump(), indent=1) + "\n")
    except OSError as error:
        code = code_of(error, "not-writable")
        raise RunError(code, f"{folder}: {error.strerror}", "make room, then give --resume") from None
    return folder / MANIFEST


def _copy_policies(plan: Plan, folder: Path) -> list[str]:
    """Copy the networks of the user, so that others can run them; irsim's own are wherever it is."""
    copies = list[str]()
    for name, text in plan.policies.items():
        file = file_of(plan.sources.get(name, text))
        if file is None or file.suffix != ".npz" or name not in plan.digests:
            continue
        copy = policy_file(plan.digests[name])
        (folder / POLICIES).mkdir(exist_ok=True)
        shutil.copyfile(file, folder / copy)
        copies.append(copy)
    return copies


def _record(plan: Plan, folder: Path, chosen: list[tuple[str, str, int]]) -> list[SampledEpisode]:
    """Record some episodes; an episode that an interrupted submission has recorded stays."""
    scenarios = {scenario.name: scenario for scenario in plan.scenarios}
    policies = {label_of(policy): policy for policy in plan.opened()}
    (folder / RUNS).mkdir(exist_ok=True)
    sample = list[SampledEpisode]()
    for number, (scenario, name, seed) in enumerate(chosen):
        place = f"{RUNS}/{number:02d}"
        target = folder / place
        if not (target / "result.json").is_file():
            if target.exists() and any(target.iterdir()):
                what = f"'{target}' holds a part of a recorded episode"
                raise RunError("file-exists", what, "delete this folder, then give --resume")
            policy = shared_with(policies[plan.policies[name]], plan.parts().get(scenario, {}))
            if not record_episode(scenarios[scenario], seed, plan, policy, target):
                what = f"the episode {scenario}, {name}, seed {seed} cannot be recorded: its map cannot be copied"
                raise RunError("file-access", what, "name maps relative to the file of the suite")
        sample.append(SampledEpisode(scenario=scenario, policy=name, seed=seed, folder=place))
    return sample


def table_of(result: BenchmarkResult, names: dict[str, str]) -> str:
    """All episodes with all metrics, as comma-separated values.

    Args:
        result: The result.
        names: Text of each policy -> its name.
    """
    out = io.StringIO()
    lines = csv.writer(out, lineterminator="\n")
    lines.writerow(["policy", *_COLUMNS, *KEYS])
    for one in result.episodes:
        values = [names[one.behavior], *(getattr(one, key) for key in _COLUMNS), *(one.metrics[key] for key in KEYS)]
        lines.writerow(["" if v is None else cell(v) if isinstance(v, str) else repr(v) for v in values])
    return out.getvalue()
