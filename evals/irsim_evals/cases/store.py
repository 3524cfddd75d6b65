"""Where cases and their golds lie, and how they are read: the values of the parameters are put into every text."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from irsim.common.hashing import digest
from irsim.scenario.yaml.document import Document, load_data, load_path
from irsim_evals.cases.drawing import draw
from irsim_evals.cases.expressions import substitute
from irsim_evals.cases.model import Case
from irsim_evals.cases.reading import folder, read_case
from irsim_evals.grader.artefact import CALLS_FILE, Answer, calls_of, from_folder
from irsim_evals.grader.material import write_files

__all__ = [
    "PUBLISHED", "Instance", "Store", "case_files", "case_ids", "case_of", "cases_hash",
    "given_pictures", "golds_of", "instance_of", "raw_case", "sets_of", "write_given",
]  # fmt: skip


@dataclass(frozen=True)
class Instance:
    """A case with values.

    Attributes:
        case: The case, in which every expression is replaced by its value.
        values: Parameters and derived values.
        name: Empty for the case as published, else the seed of the instance.
        prompt: The request to the agent.
    """

    case: Case
    values: Mapping[str, Any]
    name: str
    prompt: str

    @property
    def requests(self) -> tuple[str, ...]:
        """All that the user says, one text for each turn."""
        return (self.prompt, *self.case.turns)


def instance_of(raw: Mapping[str, Any] | Document, seed: int | None = None) -> Instance:
    """An instance of a case file.

    Args:
        raw: The file, or its content.
        seed: Seed of a fresh instance; None for the case as published.

    Raises:
        CaseError: Something is wrong with the file.
    """
    document = raw if isinstance(raw, Document) else load_data(raw)
    name = document.data.get("id") if isinstance(document.data, Mapping) else ""
    rng = None if seed is None else random.Random(f"{name} {seed}")
    case, values = read_case(document, rng)
    prompts = [case.prompt, *case.wordings]
    prompt = case.prompt if rng is None else rng.choice(prompts)
    return Instance(case, values, "" if seed is None else str(seed), prompt)


class Store(NamedTuple):
    """Where cases and their golds lie.

    Attributes:
        cases: Folder of the case files. Those in a folder within it are a set, which has the name of that folder.
        golds: Folder with a folder for each case, which has a folder for each answer.
    """

    cases: Path
    golds: Path


PUBLISHED = Store(folder("cases"), folder("golds"))
"""The cases that come with this package."""


def case_files(store: Store = PUBLISHED) -> dict[str, Path]:
    """Id → file of each case, including the cases in sets, in alphabetical order."""
    return {path.stem: path for path in sorted(store.cases.rglob("*.yaml"), key=lambda path: path.stem)}


def case_ids(store: Store = PUBLISHED, *, sets: bool = False) -> list[str]:
    """Ids of the cases that commands are about unless others are named.

    Args:
        store: Folders of the cases and their golds.
        sets: Whether cases in sets directly below the folder are included; cases in deeper sets, such as the tasks of
            the skills, must be named.
    """
    patterns = ("*.yaml", "*/*.yaml") if sets else ("*.yaml",)
    return sorted({path.stem for pattern in patterns for path in store.cases.glob(pattern)})


def sets_of(path: Path, store: Store = PUBLISHED) -> tuple[str, ...]:
    """The sets that a case file belongs to: ``("skills", "irsim-scenario")``."""
    return path.relative_to(store.cases).parts[:-1]


def raw_case(case_id: str, store: Store = PUBLISHED) -> Any:
    """Content of a case file.

    Raises:
        KeyError: There is no such case.
    """
    return load_path(case_files(store)[case_id]).data


def case_of(case_id: str, seed: int | None = None, store: Store = PUBLISHED) -> Instance:
    """An instance of a case; as published without a seed.

    Raises:
        CaseError: Something is wrong with its file.
    """
    return instance_of(load_path(case_files(store)[case_id]), seed)


def cases_hash(store: Store = PUBLISHED) -> str:
    """Digest of all case files that count without being named."""
    files = case_files(store)
    return digest(*(files[case_id].read_bytes() for case_id in case_ids(store)))[:16]


def golds_of(instance: Instance, store: Store = PUBLISHED) -> list[Answer]:
    """The golds of a case: answers that are known to be right."""
    root = store.golds / instance.case.id
    return [_gold(path, instance) for path in sorted(root.iterdir()) if path.is_dir()] if root.is_dir() else []


def given_pictures(instance: Instance) -> dict[str, bytes]:
    """The pictures that the folder of a case starts with: name → content of the file."""
    return {name: draw(drawing) for name, drawing in instance.case.drawings.items()}


def write_given(folder: Path, instance: Instance) -> None:
    """Write the files and pictures that the folder of a case starts with."""
    write_files(folder, instance.case.files, given_pictures(instance))


def _gold(path: Path, instance: Instance) -> Answer:
    left = from_folder(path, len(instance.requests))

    def filled(text: str) -> str:
        return str(substitute(text + "\0", instance.values)).rstrip("\0")  # a text, also if it is one expression

    return Answer(
        path.name, {**instance.case.files, **{name: filled(text) for name, text in left.files.items()}},
        filled(left.reply), tuple(map(filled, left.replies)), {**given_pictures(instance), **left.blobs},
        calls=calls_of(path / CALLS_FILE)[0],
    )  # fmt: skip
