"""Reads a submission: its manifest, its files with their hashes, its plan and its result."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from pydantic import ValidationError

from irsim.api.audit.problems import Problems
from irsim.benchmarks.log import in_order
from irsim.benchmarks.plan import Plan
from irsim.benchmarks.stored import EPISODES, PLAN, RESULTS
from irsim.benchmarks.submission import MANIFEST, POLICIES, ROWS, RUNS, Manifest
from irsim.common.hashing import file_digest
from irsim.common.records import ContentError, read_bytes, read_json
from irsim.diagnostics.errors import IrsimError
from irsim.results.benchmark import BenchmarkResult, SuiteResult

__all__ = ["MAX_FILE_BYTES", "check_log", "files_are_whole", "read_manifest", "read_plan", "read_result"]

_MAX_FILES = 2000
MAX_FILE_BYTES = 512 * 1024**2


def read_manifest(folder: Path, problems: Problems) -> Manifest | None:
    """The manifest; None if it cannot be read, which is a problem."""
    try:
        data = read_json(read_bytes(folder / MANIFEST, follow=False), unique=True)
        return Manifest.model_validate(data)
    except ContentError as error:
        problems.add("bad-submission", MANIFEST, f"it cannot be read: {error.message}")
    except ValidationError:
        problems.add("bad-submission", MANIFEST, "it has other keys or values than irsim writes")
    return None


def files_are_whole(folder: Path, manifest: Manifest, problems: Problems) -> bool:
    """Whether each file of the manifest is there with its digest, and no other one lies among records and policies."""
    before = problems.count
    if len(manifest.files) > _MAX_FILES:
        what = f"it lists {len(manifest.files)} files"
        problems.add("bad-submission", MANIFEST, what, allowed=f"up to {_MAX_FILES}")
        return False
    for name in (PLAN, EPISODES, RESULTS, ROWS):
        if name not in manifest.files:
            problems.add("submission-file", name, "the manifest does not list it")
    for name, known in manifest.files.items():
        if (why := _why_odd(folder, name)) is not None:
            problems.add("submission-file", name, why)
        elif file_digest(folder / name) != known:
            problems.add("submission-file", name, "its SHA-256 is not the one of the manifest: it was changed")
    for path in [path for part in (RUNS, POLICIES) for path in sorted((folder / part).rglob("*"))[: 2 * _MAX_FILES]]:
        name = path.relative_to(folder).as_posix()
        if (path.is_symlink() or not path.is_dir()) and name not in manifest.files:
            problems.add("submission-file", name, "the manifest does not list it")
    return problems.count == before


def _why_odd(folder: Path, name: str) -> str | None:
    """Why a path of the manifest is not read; None if it is an ordinary file of the folder."""
    path = PurePosixPath(name)
    if (
        path.is_absolute()
        or "\\" in name
        or ":" in name
        or "\0" in name
        or any(part in ("..", "") for part in path.parts)
    ):
        return "it does not name a file within the folder"
    step = folder
    for part in path.parts:
        step = step / part
        if step.is_symlink():
            return "it is a link, or lies behind one"
    if not step.is_file():
        return "it is missing, or no ordinary file"
    if step.stat().st_size > MAX_FILE_BYTES:
        return f"it is larger than {MAX_FILE_BYTES} bytes"
    return None


def read_plan(folder: Path, manifest: Manifest, problems: Problems) -> Plan | None:
    """The plan, which the manifest must name; None if it cannot be read."""
    try:
        plan = Plan.model_validate(read_json(read_bytes(folder / PLAN, follow=False), unique=True), strict=False)
    except (ContentError, ValidationError):
        problems.add("bad-submission", PLAN, "it is not the plan of a benchmark")
        return None
    if plan.suite is None:
        problems.add("bad-submission", PLAN, "it is not the plan of a suite")
        return None
    facts: dict[str, tuple[object, object]] = {
        "plan_hash": (manifest.plan_hash, plan.hash),
        "suite": (manifest.suite, plan.suite.suite),
        "suite_version": (manifest.suite_version, plan.suite.version),
        "suite_hash": (manifest.suite_hash, plan.suite_hash),
        "irsim": (manifest.irsim, plan.version),
        "seeds": (manifest.seeds, plan.seeds),
        "policies": (sorted(manifest.policies), sorted({*plan.policies, *plan.digests})),
    }
    for key, (given, known) in facts.items():
        if given != known:
            problems.add("bad-submission", MANIFEST, f"{key} is not the one of {PLAN}", given=given, allowed=known)
    for name, digest in plan.digests.items():
        if manifest.policies.get(name) != digest:
            problems.add("bad-submission", MANIFEST, f"the hash of the policy {name} is not the one of {PLAN}")
    return plan


def read_result(folder: Path, manifest: Manifest, problems: Problems) -> SuiteResult | None:
    """The result, which must name version and engine of the manifest; None if it cannot be read."""
    try:
        content = read_bytes(folder / RESULTS, MAX_FILE_BYTES, follow=False)
        result = SuiteResult.model_validate(read_json(content, unique=True), strict=False)
    except ContentError as error:
        problems.add("bad-submission", RESULTS, f"it cannot be read: {error.message}")
        return None
    except ValidationError:
        problems.add("bad-submission", RESULTS, "it has other keys or values than irsim writes")
        return None
    for key, given, known in (("version", result.version, manifest.irsim), ("engine", result.engine, manifest.engine)):
        if given != known:
            what = f"its {key} is not the one of {MANIFEST}"
            problems.add("submission-engine", RESULTS, what, given=given, allowed=known)
    return result


def check_log(folder: Path, result: SuiteResult, problems: Problems) -> None:
    """Whether the log has the same episodes, under a first line that agrees with the result."""
    try:
        text = read_bytes(folder / EPISODES, MAX_FILE_BYTES, follow=False)
        head = BenchmarkResult.model_validate_json(text.partition(b"\n")[0])
        again = in_order(folder / EPISODES, result.episodes).encode()
    except (ContentError, ValidationError, IrsimError, UnicodeDecodeError):
        problems.add("submission-rows", EPISODES, "it is not the log of a benchmark")
        return
    own = result.model_dump()
    odd = [key for key, value in head.model_dump().items() if key not in _LATER and value != own[key]]
    if text != again or odd:
        what = f"it has other {', '.join(odd) or 'episodes'} than {RESULTS}"
        problems.add("submission-rows", EPISODES, what)


_LATER = ("rows", "pairs", "ranks", "episodes", "incidents", "notes", "reproduce")
"""Keys of a result that its log gets at the end."""
