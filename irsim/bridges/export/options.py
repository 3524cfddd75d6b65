"""Options as commands and programs give them, checked by their model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar, overload

from pydantic import ValidationError

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.options.base import Options
from irsim.scenario.messages.of_options import option_message, option_problems

__all__ = ["chosen_options"]

Model = TypeVar("Model", bound=Options)


@overload
def chosen_options(model: type[Model], given: Mapping[str, Any], owner: str) -> Model: ...
@overload
def chosen_options(model: None, given: Mapping[str, Any], owner: str) -> None: ...
@overload
def chosen_options(model: type[Options] | None, given: Mapping[str, Any], owner: str) -> Options | None: ...
def chosen_options(model: type[Options] | None, given: Mapping[str, Any], owner: str) -> Options | None:
    """The options of something.

    Args:
        model: Their model; None if there are none.
        given: What was given.
        owner: What the options are of, as the subject of a sentence.

    Raises:
        ArgumentError: There is no such option, or a value is not allowed.
    """
    known = list(model.model_fields) if model is not None else []
    for key in given:
        if key not in known:
            listed = f"its options are {', '.join(known)}" if known else "it has none: leave it out"
            raise ArgumentError(f"{owner} has no option {clean(key)!r}", suggestion(key, known, listed))
    if model is None:
        return None
    try:
        return model.model_validate(dict(given))
    except ValidationError as error:
        message, fix = option_message(option_problems(error, dict(given), model))
        raise ArgumentError(f"{owner}: {message}", fix or "give an allowed value") from None
