"""The plan of a benchmark of scenario files, for a folder from which it can go on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from irsim.benchmarks.comparison import DEFAULT_SEEDS
from irsim.benchmarks.plan import Plan, PlannedScenario, map_hashes
from irsim.benchmarks.policies import files_of
from irsim.benchmarks.seeds import seeds_from
from irsim.scenario.open import import_modules, source_of
from irsim.scenario.perturbation import perturbation_text, read_perturbations
from irsim.scenario.yaml.document import Document, load_path

__all__ = ["file_plan"]


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
        BenchmarkError: The seeds are invalid, or the file of a policy does not exist.
    """
    documents = [_document(file) for file in files]
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


def _document(file: str) -> Document:
    found = source_of(file, None, None)
    return found if isinstance(found, Document) else load_path(found)
