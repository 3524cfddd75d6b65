"""The work of ``irsim benchmark``: files, a suite, or what an interrupted benchmark has left in its folder."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from irsim.api.benchmark_report import Report, write_report
from irsim.api.submission import write_submission
from irsim.benchmarks import DEFAULT_SEEDS, benchmark
from irsim.benchmarks.plan import file_plan
from irsim.benchmarks.seeds import seeds_from
from irsim.benchmarks.stored import PLAN, default_folder, last_folder, resume_benchmark, run_plan
from irsim.benchmarks.suite import is_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.cli.findings import limits_for
from irsim.cli.guard import again, going_on
from irsim.cli.output import console, progress, show_written
from irsim.diagnostics.errors import InputError
from irsim.scenario.behavior_override import AS_WRITTEN, split_behaviors

if TYPE_CHECKING:
    from irsim.benchmarks.plan import Plan
    from irsim.results.benchmark import BenchmarkResult

__all__ = ["Wanted", "run_benchmark"]


@dataclass(frozen=True)
class Wanted:
    """The arguments of the command; see there."""

    files: Sequence[str]
    policies: str | None
    seeds: str
    perturb: Sequence[str]
    steps: int | None
    strict: bool
    imports: Sequence[str]
    workers: int | None
    cluster: str | None
    max_objects: int | None
    folder: Path | None
    resume: bool
    full: bool
    protocols: Sequence[str]
    scenarios: Sequence[str]
    submit: bool = False


def run_benchmark(wanted: Wanted) -> BenchmarkResult:
    """Run a benchmark, and write its report where it has a folder.

    Raises:
        InputError: The arguments do not fit together.
    """
    suites = [word for word in wanted.files if is_suite(word)]
    if suites and len(wanted.files) > 1:
        raise InputError(f"{suites[0]} is a suite, which is run alone", "give one suite, or scenario files")
    of_suite = {
        "--submission": wanted.submit and bool(wanted.files),
        "--full": wanted.full,
        "--protocol": wanted.protocols,
        "--scenario": wanted.scenarios,
    }
    odd = [name for name, value in of_suite.items() if value and not suites]
    if odd:
        raise InputError(f"{odd[0]} belongs to a suite", "name a suite; irsim suites lists them")
    limits, reports, manifests = limits_for(wanted.max_objects), list[Report](), list[Path]()

    def finish(result: BenchmarkResult, folder: Path) -> None:
        reports.append(write_report(result, folder))
        if wanted.submit:
            manifests.append(write_submission(result, folder))

    folders = list[Path]()
    with going_on(lambda: _go_on(folders, wanted)), progress("simulating") as report:
        if not wanted.files:
            if not wanted.resume:
                raise InputError("there is nothing to run", "give scenario files, a suite, or --resume")
            folder = wanted.folder or last_folder()
            folders.append(folder)
            result = resume_benchmark(
                folder, workers=wanted.workers, cluster=wanted.cluster, progress=report, limits=limits, finish=finish
            )
        elif suites or wanted.folder is not None or wanted.resume:
            plan = _suite(suites[0], wanted) if suites else _plan(wanted)
            folder = wanted.folder or default_folder(plan)
            folders.append(folder)
            result = run_plan(
                plan,
                folder,
                resume=wanted.resume,
                workers=wanted.workers,
                cluster=wanted.cluster,
                progress=report,
                limits=limits,
                finish=finish,
            )
        else:
            policies = [AS_WRITTEN] if wanted.policies is None else split_behaviors(wanted.policies)
            return benchmark(
                list(wanted.files), policies, wanted.seeds or DEFAULT_SEEDS, perturb=wanted.perturb or None,
                steps=wanted.steps, strict=wanted.strict, imports=wanted.imports, workers=wanted.workers,
                cluster=wanted.cluster, limits=limits, progress=report,
            )  # fmt: skip
    out = console(stderr=True)
    for written in reports:
        show_written(written.page, "the report; episodes and result are beside it", stderr=True)
        for note in written.notes:
            out.print(f"note: {note}", soft_wrap=True)
    for manifest in manifests:
        show_written(manifest, "the submission", stderr=True)
        out.print(f"check it: irsim audit {manifest.parent}", soft_wrap=True)
    return result


def _go_on(folders: Sequence[Path], wanted: Wanted) -> str:
    """How an interrupted benchmark goes on."""
    if not folders:
        return f"no episode is kept without a folder; again, and kept: {again(['-o', 'results'])}"
    [folder] = folders
    if not (folder / PLAN).is_file():
        return f"again: {again()}"
    how = ["--submission" if wanted.submit else "-o", str(folder)]
    for option, value in (("--workers", wanted.workers), ("--cluster", wanted.cluster)):
        how += [option, str(value)] if value is not None else []
    return f"finished episodes are kept; go on: {shlex.join(['irsim', 'benchmark', '--resume', *how])}"


def _suite(name: str, wanted: Wanted) -> Plan:
    """The plan of a suite.

    Raises:
        InputError: An argument belongs to scenario files.
    """
    for option, value in (("--steps", wanted.steps), ("--import", wanted.imports)):
        if value:
            fix = "a suite states its horizon and its policies: change them in its file"
            raise InputError(f"{option} belongs to scenario files", fix)
    return suite_plan(
        name,
        policies=None if wanted.policies is None else split_behaviors(wanted.policies),
        protocols=wanted.protocols or None,  # type: ignore[arg-type]
        seeds=_suite_seeds(wanted.seeds),
        full=wanted.full,
        scenarios=wanted.scenarios or None,
        perturb=wanted.perturb,
    )


def _suite_seeds(text: str) -> int | list[int] | None:
    """The seeds of a suite: their number, the seeds, or None for the seeds of the suite."""
    if not text or text.strip().isdecimal():
        return int(text) if text else None

    return seeds_from(text)


def _plan(wanted: Wanted) -> Plan:
    """The plan of scenario files."""
    return file_plan(
        wanted.files,
        [AS_WRITTEN] if wanted.policies is None else split_behaviors(wanted.policies),
        wanted.seeds,
        steps=wanted.steps,
        strict=wanted.strict,
        imports=wanted.imports,
        perturb=wanted.perturb,
    )
