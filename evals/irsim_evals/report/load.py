"""Reading files of results and of a proof, and putting several into one."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from irsim.common.text import clean
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.results import Results, Trial, read_results

__all__ = ["Proof", "ProofRow", "load_proof", "load_results", "merge"]

_MAX_MESSAGE = 120
"""Characters of somebody else's message that an error repeats."""


class ProofRow(BaseModel):
    """One kind and operator of the proof."""

    kind: str
    operator: str
    trials: int
    wrong: int


class Proof(BaseModel):
    """What ``irsim-evals prove --json`` printed, as far as the report shows it."""

    model_config = ConfigDict(extra="ignore")

    rows: list[ProofRow]
    wrong: list[dict[str, Any]] = []
    left_out: dict[str, int] = {}
    seconds: float = 0.0


def load_results(path: Path) -> Results:
    """Read a file of results, or ``results.json`` of a folder.

    Raises:
        ArgumentError: There is no such file, it holds something else, or it holds no trials.
    """
    try:
        results = read_results(path)
    except FileNotFoundError:
        raise ArgumentError(f"there is no file of results at {path}", _ADVICE) from None
    except (OSError, UnicodeDecodeError) as error:
        raise ArgumentError(f"{path} cannot be read: {error}", _ADVICE) from None
    except ValidationError as error:
        raise ArgumentError(f"{path} is not a file of results: {_first(error)}", _ADVICE) from None
    if not results.trials:
        raise ArgumentError(f"{path} holds no trials", _ADVICE)
    return results


_ADVICE = "write one with irsim-evals grade DIR --output FILE or irsim-evals run"


def load_proof(path: Path) -> Proof:
    """Read what ``irsim-evals prove --json`` printed.

    Raises:
        ArgumentError: There is no such file, or it holds something else.
    """
    advice = "write one with irsim-evals prove --json > FILE"
    try:
        return Proof.model_validate(json.loads(path.read_text(encoding="utf-8")))
    except ValidationError as error:
        raise ArgumentError(f"{path} is not the JSON of a proof: {_first(error)}", advice) from None
    except (OSError, ValueError, RecursionError) as error:
        raise ArgumentError(f"{path} is not the JSON of a proof: {error}", advice) from None


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


def _first(error: ValidationError) -> str:
    """The first problem in one line."""
    problem = error.errors()[0]
    where = ".".join(str(part) for part in problem["loc"])
    return clean(f"{where}: {problem['msg']}" if where else problem["msg"], _MAX_MESSAGE)
