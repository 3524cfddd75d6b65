"""Everything that the numbers of a benchmark depend on, as plain data: what a folder needs to go on after a stop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, model_serializer

from irsim.benchmarks.policies import files_of, open_planned
from irsim.benchmarks.preparation import DEFAULT_SEEDS
from irsim.benchmarks.roles import COMPARED
from irsim.benchmarks.seeds import seeds_from
from irsim.benchmarks.suite import Protocol, Suite
from irsim.common.hashing import digest, file_digest
from irsim.common.installed import version as this_version
from irsim.policies.policy import Policy
from irsim.results.run import EpisodeUntil
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.scenario.open import document_of, import_modules
from irsim.scenario.perturbation import perturbation_text, read_perturbations
from irsim.scenario.read import read
from irsim.scenario.yaml.document import Document, load_text

__all__ = ["Plan", "PlannedScenario", "file_plan", "map_hashes", "short_hash"]

_HASH_LENGTH = 12


class PlannedScenario(BaseModel):
    """One scenario of a benchmark.

    Attributes:
        name: Name in the results.
        family, protocol, values: Its entries in the suite.
        folder: Folder relative to which it names map files; None where it names none.
        text: The scenario as YAML.
        maps: Name of each map file → SHA-256 of its content.
        policies: Name or tag of robots → policy of ``Plan.company`` that drives them, or ``compared``; empty if the
            compared policy drives all.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    family: str
    protocol: Protocol = "as-written"
    values: dict[str, Any] = {}
    folder: str | None = None
    text: str
    maps: dict[str, str] = {}
    policies: dict[str, str] = {}

    @model_serializer(mode="wrap")
    def _as_before(self, serialize: Callable[[PlannedScenario], dict[str, Any]]) -> dict[str, Any]:
        """The fields, but for new ones without a value, so that the hashes of older plans stay."""
        return {key: value for key, value in serialize(self).items() if value or key != "policies"}

    def document(self) -> Document:
        """The scenario, ready to read."""
        path = None if self.folder is None else str(Path(self.folder) / "scenario.yaml")
        return load_text(self.text, name=self.name, path=path, limits=DEFAULT_LIMITS)


class Plan(BaseModel):
    """A benchmark before it is run.

    Attributes:
        name: Name of the suite, or ``benchmark``.
        version: Version of irsim that runs it.
        suite: The suite; None for a benchmark of files.
        suite_hash: Hash of the suite, whatever part of it is run; empty without one.
        scenarios: The scenarios in order.
        policies: Name in the results → policy as text.
        company: Name → policy as text that drives robots of some scenarios, whatever policy is compared.
        sources: Name → text that opens a policy that is a file, with its full path.
        digests: Name → SHA-256 of such a file.
        seeds: The seeds.
        steps: Horizon in steps; None where each scenario has its own.
        perturb: Perturbations of the scenarios, as on the command line.
        until: When episodes end, see :class:`irsim.benchmarks.suite.Suite`.
        strict: Whether what IR-SIM 2.12 ignores is an error.
        imports: Modules that register behaviors.
        reproduce: Command that runs it.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    version: str = this_version()
    suite: Suite | None = None
    suite_hash: str = ""
    scenarios: list[PlannedScenario]
    policies: dict[str, str]
    company: dict[str, str] = {}
    sources: dict[str, str] = {}
    digests: dict[str, str] = {}
    seeds: list[int]
    steps: int | None = None
    perturb: list[str] = []
    until: EpisodeUntil = "done"
    strict: bool = False
    imports: list[str] = []
    reproduce: str = ""

    def opened(self) -> list[Policy]:
        """The policies, opened.

        Raises:
            PolicyError: The file of one has changed since the benchmark was started.
        """
        import_modules(self.imports)
        return open_planned(self.policies, self.sources, self.digests)

    def parts(self) -> dict[str, dict[str, Policy | None]]:
        """Scenario → name or tag of robots → the policy that drives them, None for the one that is compared.

        Raises:
            PolicyError: The file of one has changed since the benchmark was started.
        """
        opened = dict(zip(self.company, open_planned(self.company, self.sources, self.digests), strict=True))
        return {
            one.name: {key: None if name == COMPARED else opened[name] for key, name in one.policies.items()}
            for one in self.scenarios
            if one.policies
        }

    @property
    def groups(self) -> dict[str, list[str]]:
        """Scenarios of each tag of the suite."""
        tags: dict[str, list[str]] = {}
        for family in () if self.suite is None else self.suite.scenarios:
            for tag in family.tags:
                tags.setdefault(tag, []).extend(one.name for one in self.scenarios if one.family == family.name)
        return tags

    @property
    def hash(self) -> str:
        """Hash of everything that decides the numbers; folders and the command do not."""
        where = {
            "reproduce": True,
            "sources": True,
            "suite_hash": True,
            "suite": {"others"},
            "scenarios": {"__all__": {"folder"}},
        }
        where |= {} if self.digests else {"digests": True}
        where |= {} if self.company else {"company": True}
        text = self.model_dump_json(exclude=where)  # type: ignore[arg-type]
        return short_hash(text)


def short_hash(text: str) -> str:
    """The beginning of the SHA-256 of a text."""
    return digest(text)[:_HASH_LENGTH]


def map_hashes(documents: Sequence[Document]) -> list[dict[str, str]]:
    """Name → SHA-256 of the map files of each scenario; none of a scenario that cannot be read."""
    return [_hashes(document) for document in documents]


def _hashes(document: Document) -> dict[str, str]:
    scenario = read(document, limits=document.limits).scenario
    if scenario is None:
        return {}
    maps = {name: Path(path) for name, path in scenario.map_files.items()}
    return {name: file_digest(path) for name, path in sorted(maps.items()) if path.is_file()}


def file_plan(
    files: Sequence[str],
    policies: Sequence[str],
    seeds: str,
    *,
    steps: int | None = None,
    strict: bool = False,
    imports: Sequence[str] = (),
    perturb: Sequence[str] = (),
) -> Plan:
    """Everything that a benchmark of scenario files depends on; arguments as of :func:`irsim.benchmark`.

    Raises:
        ScenarioNotFoundError: A file does not exist.
        InputError: The seeds are invalid, or the file of a policy does not exist.
    """
    documents = [document_of(file, None, None) for file in files]
    scenarios = [
        PlannedScenario(
            name=file, family=file, text=str(document.text), maps=maps,
            folder=str(Path(document.path).parent.resolve()) if maps and document.path is not None else None,
        )
        for file, document, maps in zip(files, documents, map_hashes(documents), strict=True)
    ]  # fmt: skip
    import_modules(imports)
    texts = {text: text for text in policies}
    sources, digests = files_of(texts, {})
    return Plan(
        name="benchmark",
        scenarios=scenarios,
        policies=texts,
        sources=sources,
        digests=digests,
        seeds=seeds_from(seeds or DEFAULT_SEEDS),
        steps=steps,
        strict=strict,
        imports=list(imports),
        perturb=[perturbation_text(item) for item in read_perturbations(perturb)],
    )
