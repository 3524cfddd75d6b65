"""The manifest of a submission, and which of its episodes are recorded."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

import irsim._core as core
from irsim.benchmarks.plan import Plan, short_hash
from irsim.common.hashing import digest, file_digest
from irsim.common.installed import version
from irsim.simulation.engine import engine

__all__ = [
    *("MANIFEST", "POLICIES", "ROWS", "RUNS", "SAMPLED", "Manifest", "SampledEpisode", "manifest_of", "policy_file"),
    *("sample_seed", "sampled_episodes"),
]

MANIFEST, ROWS, RUNS, POLICIES = "submission.json", "rows.csv", "runs", "policies"
"""Names of the manifest, of the table of episodes, and of the folders of recorded episodes and of policies."""
SAMPLED = 20
"""Number of episodes that are recorded; of a smaller benchmark all are."""
Text = Annotated[str, Field(max_length=4096)]


class SampledEpisode(BaseModel):
    """An episode that is recorded."""

    model_config = ConfigDict(extra="forbid")

    scenario: Text
    policy: Text
    seed: Annotated[int, Field(ge=0, lt=2**64)]
    folder: Text


class Manifest(BaseModel):
    """``submission.json``: versions, hashes, the sample, and the digest of every other file.

    Attributes:
        format: Version of this layout.
        suite, suite_version, suite_hash: The suite.
        plan_hash: Hash of everything that decides the numbers.
        irsim, python, numpy, platform: Versions of the programs that ran it.
        engine: Identity of the engine, see :func:`irsim.simulation.engine.engine`.
        core: SHA-256 of its compiled part, which depends on system and compiler.
        policies: Name of each policy, also of the scenes' other ones -> SHA-256 of its file, or of its text where it
            has no file.
        seeds: The seeds.
        episodes: Number of episodes.
        sample: The recorded episodes: of all episodes, ordered by the SHA-256 of ``SAMPLE:SCENARIO:POLICY:SEED``, the
            first 20; for ``SAMPLE`` see :func:`sample_seed`.
        files: Path of each file -> its SHA-256.
    """

    model_config = ConfigDict(extra="forbid")

    format: Annotated[int, Field(ge=1, le=1)] = 1
    suite: Text
    suite_version: int
    suite_hash: Text
    plan_hash: Text
    irsim: Text
    python: Text
    numpy: Text
    platform: Text
    engine: Text
    core: Text
    policies: dict[Text, Text]
    seeds: list[int]
    episodes: int
    sample: list[SampledEpisode]
    files: dict[Text, Text]


def sample_seed(plan: Plan) -> str:
    """The text that decides the sample: a hash of suite, scenarios, policies and seeds, whatever their order is."""
    policies = [f"{text} {plan.digests.get(name, '')}" for name, text in plan.policies.items()]
    parts = [sorted(scenario.name for scenario in plan.scenarios), sorted(policies), sorted(plan.seeds)]
    return short_hash(json.dumps([plan.suite_hash, *parts]))


def sampled_episodes(
    seed: str, episodes: Iterable[tuple[str, str, int]], most: int | None = None
) -> list[tuple[str, str, int]]:
    """A sample of episodes, which follows from a text alone.

    Args:
        seed: The text: :func:`sample_seed` for what a submission records, the salt of a referee for what is run again.
        episodes: Scenario, name of the policy and seed of each episode.
        most: Greatest number of episodes; default: the number that is recorded.
    """
    return sorted(episodes, key=lambda one: digest(f"{seed}:{one[0]}:{one[1]}:{one[2]}"))[
        : SAMPLED if most is None else most
    ]


def policy_file(sha256: str) -> str:
    """Path of the file of a policy in a submission."""
    return f"{POLICIES}/{sha256[:16]}.npz"


def manifest_of(plan: Plan, folder: Path, episodes: int, sample: list[SampledEpisode], files: list[str]) -> Manifest:
    """The manifest of the files in a folder.

    Args:
        plan: The plan that was run.
        folder: The folder.
        episodes: Number of episodes.
        sample: The recorded episodes.
        files: Paths of all other files, relative to the folder.
    """
    assert plan.suite is not None
    return Manifest(
        suite=plan.suite.suite,
        suite_version=plan.suite.version,
        suite_hash=plan.suite_hash,
        plan_hash=plan.hash,
        irsim=version(),
        python=platform.python_version(),
        numpy=np.__version__,
        platform=platform.platform(),
        engine=engine(),
        core=file_digest(Path(str(core.__file__))),
        policies={name: digest(text) for name, text in plan.policies.items()} | plan.digests,
        seeds=plan.seeds,
        episodes=episodes,
        sample=sample,
        files={name: file_digest(folder / name) for name in sorted(files)},
    )
