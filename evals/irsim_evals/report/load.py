"""Reading files of results and of a proof, putting several into one, and finding the cases that they are about."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from irsim.common.records import ContentError, read_json
from irsim.common.text import clean
from irsim.diagnostics.errors import ArgumentError
from irsim.scenario.messages.translate import option_message, option_problems
from irsim_evals.cases.store import PUBLISHED, Instance, Store, case_files, case_of, cases_hash
from irsim_evals.proof.trials import RIGHT
from irsim_evals.results import Results, Trial
from irsim_evals.statistics import Interval, wilson

__all__ = ["Proof", "ProofRow", "asked_of", "load_proof", "load_results", "merge"]

_MAX_MESSAGE = 120
"""Characters of a foreign message that an error repeats."""
_ADVICE = "write one with irsim-evals grade DIR --output FILE or irsim-evals run"
Count = Annotated[int, Field(ge=0, le=10**12)]


class ProofRow(BaseModel):
    """One kind and operator of the proof."""

    kind: str
    operator: str
    trials: Count
    wrong: Count

    @model_validator(mode="after")
    def _check_share(self) -> ProofRow:
        if self.wrong > self.trials:
            raise ValueError(f"{self.wrong} of {self.trials} trials cannot be wrong")
        return self


class Proof(BaseModel):
    """The output of ``irsim-evals prove --json``, as far as the report shows it."""

    model_config = ConfigDict(extra="ignore")

    rows: list[ProofRow]
    wrong: list[dict[str, Any]] = []
    left_out: dict[str, Count] = {}

    def totals(self) -> list[tuple[str, int, Interval]]:
        """Wrong answers that were accepted and right ones that were rejected: name, number, share of all of them."""
        errors = []
        for name, right in (("wrong answers accepted", False), ("right answers rejected", True)):
            rows = [row for row in self.rows if (row.kind in RIGHT) == right]
            wrong, total = sum(row.wrong for row in rows), sum(row.trials for row in rows)
            errors.append((f"{name}, of {total:,}", wrong, wilson(min(wrong, total), total)))
        return errors


def load_results(path: Path) -> Results:
    """Read a file of results, or ``results.json`` of a folder.

    Raises:
        ArgumentError: There is no such file, it holds something else, or it holds no trials.
    """
    try:
        file = path / "results.json" if path.is_dir() else path
        results = Results.model_validate_json(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ArgumentError(f"there is no file of results at {path}", _ADVICE) from None
    except (OSError, UnicodeDecodeError) as error:
        raise ArgumentError(f"{path} cannot be read: {error}", _ADVICE) from None
    except ValidationError as error:
        raise ArgumentError(f"{path} is not a file of results: {_first(error, Results)}", _ADVICE) from None
    if not results.trials:
        raise ArgumentError(f"{path} holds no trials", _ADVICE)
    return results


def load_proof(path: Path) -> Proof:
    """Read what ``irsim-evals prove --json`` printed.

    Raises:
        ArgumentError: There is no such file, or it holds something else.
    """
    advice = "write one with irsim-evals prove --json > FILE"
    try:
        return Proof.model_validate(read_json(path))
    except (ValidationError, ContentError) as error:
        why = _first(error, Proof) if isinstance(error, ValidationError) else error
        raise ArgumentError(f"{path} is not the JSON of a proof: {why}", advice) from None


def merge(parts: Sequence[tuple[Path, Results]]) -> Results:
    """One table of all trials.

    Attempts of one arm at one case that have the same number in two files are numbered on.

    Raises:
        ArgumentError: The files were made with different cases, or one file is given twice.
    """
    first_path, first = parts[0]
    seen: set[Path] = set()
    taken: set[tuple[str, tuple[str, str], int]] = set()
    trials: list[Trial] = []
    for path, results in parts:
        if results.cases != first.cases:
            raise ArgumentError(
                f"{first_path} and {path} were made with different cases ({first.cases or 'none named'} and "
                f"{results.cases or 'none named'}), so their results cannot be put together",
                "grade the answers of both again with the same cases",
            )
        if path.resolve() in seen:
            raise ArgumentError(f"{path} is given twice", "name each file of results once")
        seen.add(path.resolve())
        for trial in results.trials:
            number = trial.number
            while (trial.arm, trial.key, number) in taken:
                number += 1
            taken.add((trial.arm, trial.key, number))
            trials.append(trial if number == trial.number else trial.model_copy(update={"number": number}))
    return first.model_copy(update={"trials": trials})


def _first(error: ValidationError, model: type[BaseModel]) -> str:
    """The first problem in one line."""
    return clean(option_message(option_problems(error, {}, model)[:1])[0], _MAX_MESSAGE)


def asked_of(results: Results, store: Store = PUBLISHED) -> list[Instance | None]:
    """The case of each trial as it was asked; None if it is not installed or the trials were made with other cases."""
    known = case_files(store) if results.cases == cases_hash(store) else {}
    asked: dict[tuple[str, str], Instance | None] = {}
    for case, name in {trial.key for trial in results.trials}:
        try:
            seed = int(name) if name else None
            asked[case, name] = case_of(case, seed, store) if case in known else None
        except ValueError:  # an instance that is not a number
            asked[case, name] = None
    return [asked[trial.key] for trial in results.trials]
