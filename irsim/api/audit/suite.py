"""The claim of a submission in terms of this installation: its suite, its scenes and its policies."""

from __future__ import annotations

import shlex
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from irsim.api.audit.problems import Problems
from irsim.benchmarks.plan import Plan
from irsim.benchmarks.stored import PLAN
from irsim.benchmarks.submission import Manifest, policy_file
from irsim.benchmarks.suite import SUITES
from irsim.benchmarks.suite_plan import suite_plan
from irsim.common.hashing import file_digest
from irsim.common.installed import version
from irsim.common.text import clean
from irsim.diagnostics.errors import InputError, IrsimError
from irsim.policies.catalog import file_of, has_inner_files, open_policy, with_file
from irsim.policies.policy import Policy
from irsim.scenario.behavior_override import behavior_text

__all__ = ["Claim", "claim_of"]


@dataclass(frozen=True)
class Claim:
    """The benchmark that a submission claims to have run, made of what is installed here and without its texts.

    Attributes:
        plan: Its plan, with the suite's own scenarios and the policies that it names.
        policies: Text of each policy that can be run here -> the policy.
        missing: Name of a policy -> why it cannot be run here.
        part: The part of the suite that was run, in words; empty if all of it was.
    """

    plan: Plan
    policies: dict[str, Policy]
    missing: dict[str, str] = field(default_factory=dict)
    part: str = ""


def claim_of(
    plan: Plan,
    manifest: Manifest,
    folder: Path,
    problems: Problems,
    *,
    suite: str | Path | None = None,
    files: Mapping[str, str | Path] | None = None,
) -> Claim | None:
    """Build the plan of a submission again from the installed suite; None if that is not possible, which is a problem.

    Args:
        plan: Its plan.
        manifest: Its manifest.
        folder: Its folder.
        problems: Gets what differs.
        suite: File of a suite that is not bundled.
        files: Name of a policy in the results -> its file, of policies that are files.

    Raises:
        InputError: A file is given for a policy that is not in the plan.
        SuiteError: The file of the suite cannot be read.
    """
    assert plan.suite is not None
    name = plan.suite.suite
    if suite is None and name not in SUITES.names():
        what = f"irsim {version()} has no suite {name}, so nothing of it can be checked"
        problems.add("submission-suite", PLAN, what, given=name, fix="name its file: irsim audit DIR --suite FILE")
        return None
    own = suite_plan(name if suite is None else str(suite))
    if own.suite_hash != plan.suite_hash or own.suite != plan.suite:
        what = f"the suite is not {name} of irsim {version()}"
        problems.add("submission-suite", PLAN, what, given=plan.suite_hash, allowed=own.suite_hash)
        return None
    known = {scenario.name: scenario for scenario in own.scenarios}
    names = [scenario.name for scenario in plan.scenarios]
    before = problems.count
    for scenario in plan.scenarios:
        mine = known.get(scenario.name)
        if mine is None or mine.model_copy(update={"folder": None}) != scenario.model_copy(update={"folder": None}):
            problems.add("submission-suite", PLAN, f"the suite has no such scenario {scenario.name}")
    if not plan.seeds or plan.seeds != sorted(set(plan.seeds)) or not 0 <= plan.seeds[0] <= plan.seeds[-1] < 2**64:
        problems.add("submission-suite", PLAN, "its seeds are not in order, or one is there twice, or all are missing")
    if not plan.scenarios or not plan.policies:
        problems.add("submission-suite", PLAN, "it has no scenario or no policy")
    for label, text in plan.policies.items():
        meant = plan.suite.known_policies.get(label)
        if text != (label if meant is None else behavior_text(meant)):
            problems.add("submission-suite", PLAN, f"the policy {label} is another one than its name says", given=text)
    if problems.count > before:
        return None
    again = suite_plan(name if suite is None else str(suite), policies=["dash"], seeds=plan.seeds, scenarios=names)
    if (unknown := next((label for label in files or {} if label not in plan.policies), None)) is not None:
        what = f"the submission has no policy {clean(unknown)}"
        raise InputError(what, f"its policies are {', '.join(clean(label, 60) for label in plan.policies)}")
    opened, missing = _policies(plan, manifest, folder, files or {}, problems)
    digests = {label: plan.digests[label] for label in plan.policies if label in plan.digests}
    trusted = again.model_copy(
        update={
            "version": plan.version,
            "policies": dict(plan.policies),
            "sources": again.sources,
            "digests": {**again.digests, **digests},
            "reproduce": plan.reproduce,
        }
    )
    if trusted.hash != plan.hash:
        mine_, theirs = trusted.model_dump(exclude={"scenarios"}), plan.model_dump(exclude={"scenarios"})
        skipped = ("reproduce", "sources", "suite_hash")
        odd = [key for key in mine_ if key not in skipped and mine_[key] != theirs[key]]
        what = f"it is not what irsim plans for this suite; different: {', '.join(odd) or 'its scenarios'}"
        problems.add("submission-suite", PLAN, what)
        return None
    _check_command(plan, problems)
    return Claim(trusted, opened, missing, _part(plan, own))


def _policies(
    plan: Plan, manifest: Manifest, folder: Path, files: Mapping[str, str | Path], problems: Problems
) -> tuple[dict[str, Policy], dict[str, str]]:
    """The policies that can be run, by text, and why the others cannot, by name.

    Only policies that are installed with irsim, and files of numbers, are opened: no plug-in and no program is.
    """
    opened, missing = dict[str, Policy](), dict[str, str]()
    for name, text in plan.policies.items():
        try:
            policy = _opened(name, text, plan, manifest, folder, files.get(name))
        except IrsimError as error:
            missing[name] = str(error)
            continue
        if policy is None:
            missing[name] = f"its file is not here; give it with --policy {name}=FILE"
        elif policy.digest != plan.digests.get(name):
            what = f"the policy {name} that is here has another hash than the one of the plan"
            problems.add("submission-suite", PLAN, what, given=plan.digests.get(name), allowed=policy.digest)
            missing[name] = "the file that is here is another one"
        else:
            policy.text = text
            opened[text] = policy
    return opened, missing


def _opened(
    name: str, text: str, plan: Plan, manifest: Manifest, folder: Path, given: str | Path | None
) -> Policy | None:
    """A policy; None if its file is not here."""
    if file_of(text) is not None:
        if given is not None:
            return open_policy(with_file(text, Path(given).resolve()))
        inside = policy_file(plan.digests.get(name, ""))
        if inside not in manifest.files or file_digest(folder / inside) != plan.digests.get(name):
            return None
        return open_policy(with_file(text, (folder / inside).resolve()))
    if has_inner_files(text):
        return None
    with tempfile.TemporaryDirectory() as empty:
        return open_policy(text, root=empty)


def _check_command(plan: Plan, problems: Problems) -> None:
    """Readers paste the command, so it must be one command of irsim."""
    try:
        words = shlex.split(plan.reproduce)
    except ValueError:
        words = []
    if words[:2] != ["irsim", "benchmark"] or shlex.join(words) != plan.reproduce or "\n" in plan.reproduce:
        problems.add("submission-suite", PLAN, "the command that reproduces it is not one of irsim")


def _part(plan: Plan, own: Plan) -> str:
    """The part of the suite that was run, and whether its author has chosen the seeds, in words."""
    parts = []
    if len(plan.scenarios) < len(own.scenarios):
        parts.append(f"{len(plan.scenarios)} of {len(own.scenarios)} scenarios")
    first = own.seeds[0]
    if plan.seeds[:1] != [first] or plan.seeds != list(range(first, first + len(plan.seeds))):
        parts.append(f"{len(plan.seeds)} seeds that its author has chosen")
    elif len(plan.seeds) < len(own.seeds):
        parts.append(f"{len(plan.seeds)} of {len(own.seeds)} seeds")
    return f"a part of the suite: {', '.join(parts)}" if parts else ""
