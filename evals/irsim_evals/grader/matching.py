"""How an assertion says which values it accepts: quantities with units, and tolerances where it does not say more."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WrapValidator, model_validator
from pydantic_core import PydanticCustomError

from irsim.bundled.templates.fill import evaluate
from irsim.common.angles import wrap
from irsim.common.arguments import is_number
from irsim.options.base import problem, problems_at
from irsim_evals.grader.words import unknown

__all__ = [
    "TOLERANCES", "UNITS", "Counted", "Kind", "Match", "Place", "Quantity", "Relation", "Seeds", "checked", "fitting",
    "matches", "quantity", "show",
]  # fmt: skip

UNITS: dict[str, float] = {
    "m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "ft": 0.3048, "in": 0.0254, "yd": 0.9144,
    "rad": 1.0, "deg": math.pi / 180, "°": math.pi / 180, "turn": 2 * math.pi,
    "s": 1.0, "ms": 0.001, "min": 60.0, "h": 3600.0, "Hz": 1.0,
    "kg": 1.0, "g": 0.001, "%": 0.01, "": 1.0,
}  # fmt: skip
"""Factor from a unit to metres, radians, seconds, kilograms or 1."""
_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d/]*)(?:/([^\s\d/]+))?\s*")
Kind = Literal["count", "length", "size", "angle", "heading", "axis", "speed", "rate", "time", "share", "name", "flag"]
"""The kind of quantity, which decides how closely values must agree."""
TOLERANCES: dict[str, tuple[float, float]] = {
    "count": (0.0, 0.0), "length": (0.02, 0.05), "size": (0.02, 0.01), "share": (0.02, 0.005), "time": (0.02, 0.001),
    "angle": (0.0, math.radians(2)), "heading": (0.0, math.radians(2)), "axis": (0.0, math.radians(2)),
    "speed": (0.02, 0.01), "rate": (0.02, 0.01),
}  # fmt: skip
"""Relative and absolute tolerance of each kind of number; the larger one applies."""
MAX_QUANTITY = 1e9
"""Largest number of a case, in SI units."""
Place = tuple[int | str, ...]
_ROUGHLY = 0.2
"""Relative tolerance of `about`: what a prompt calls about, roughly or circa."""


def quantity(value: float | int | str) -> float:
    """A number in m, rad, s or kg (and quotients of them) from a number or a text with a unit.

    Raises:
        ValueError: The text is not a number with a known unit.
    """
    if isinstance(value, bool):
        raise ValueError(f"{value!r} is not a quantity")
    if isinstance(value, (int, float)):
        return float(value)
    match = _QUANTITY.fullmatch(value)
    if match is None:
        raise ValueError(f"{value!r} is not a number with a unit such as 5.4km/h")
    number, unit, per = match.groups()
    for name in filter(None, (unit, per)):
        if name not in UNITS:
            raise ValueError(f"{value!r}: the unit {name!r} is not known; known are {', '.join(filter(None, UNITS))}")
    return float(number) * UNITS[unit] / (UNITS[per] if per else 1.0)


Quantity = Annotated[float, Field(allow_inf_nan=False, ge=-MAX_QUANTITY, le=MAX_QUANTITY), BeforeValidator(quantity)]
"""A number in SI units, or a text with a unit."""
Counted = Annotated[int, Field(ge=0, le=100_000)]
"""A number of things: steps, episodes, laps, robots."""
Seeds = Annotated[list[Annotated[int, Field(ge=0, lt=2**53)]], Field(min_length=1, max_length=1000)]
"""Seeds of episodes or worlds."""


_REFERENCE = re.compile(r"\b([A-Za-z_]\w*)\.([a-z_]\w*)")


@dataclass(frozen=True)
class Relation:
    """A number that depends on the answer, such as ``= robots.width + 0.1``.

    Attributes:
        text: As written.
    """

    text: str

    def __str__(self) -> str:
        return self.text

    @property
    def references(self) -> list[tuple[str, str]]:
        """Selection, or ``world``, and property of each value in it."""
        return _REFERENCE.findall(self.text)

    @property
    def names(self) -> list[str]:
        """Names of these values in the expression."""
        return [f"value_{number}" for number, _ in enumerate(self.references)]

    @property
    def expression(self) -> str:
        """The expression over them."""
        names = iter(self.names)
        return _REFERENCE.sub(lambda _: next(names), self.text.removeprefix("=").strip())


def _relation(value: Any) -> Relation | None:
    """The relation that a text expresses; None for any other value.

    Raises:
        ValueError: The text begins like a relation but is not a valid one.
    """
    if not isinstance(value, str) or not value.lstrip().startswith("="):
        return None
    relation = Relation(value.strip())
    if not relation.references:
        raise ValueError(f"{value!r} names no property, as `= robots.width + 0.1` does")
    evaluate(relation.expression, dict.fromkeys(relation.names, 1.0))
    return relation


def _limit(value: Any, number: Any) -> Any:
    return _relation(value) or number(value)


Limit = Annotated[Quantity, WrapValidator(_limit)]
"""A quantity, or a relation."""


def _value(value: Any) -> Any:
    """A text that is a quantity as its number; lists element by element; anything else as it is."""
    if isinstance(value, list):
        return [_value(item) for item in value]
    if isinstance(value, str):
        if relation := _relation(value):
            return relation
        try:
            return quantity(value)
        except ValueError:
            return value
    if isinstance(value, (int, float)) and not abs(value) <= MAX_QUANTITY:
        raise ValueError(f"{value!r} is not between -{MAX_QUANTITY:g} and {MAX_QUANTITY:g}")
    return value


_LIMITS = {"minimum": -MAX_QUANTITY, "maximum": MAX_QUANTITY}


class Match(BaseModel):
    """Accepted values: one of the keys, or several that must all hold. A bare value stands for ``eq``.

    A number may be a relation, ``= 2 * robots.width + 0.1``: an expression over properties of selections and of the
    ``world``. Where bodies of a selection differ, `ge` and `le` hold for each of them."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    also_called: ClassVar[dict[str, str]] = {
        "min": "ge", "max": "le", "equals": "eq", "least": "ge", "most": "le", "gt": "ge", "lt": "le", "ne": "not",
    }  # fmt: skip
    """Words of authors → keys, for messages."""

    eq: Annotated[Any, BeforeValidator(_value)] = None
    """Equal, within `tol` or the tolerance of the kind; a list is compared element by element."""
    about: Annotated[Any, BeforeValidator(_value)] = None
    """Equal within 20 %."""
    among: Annotated[list[Any] | None, BeforeValidator(_value), Field(alias="in")] = None
    """Equal to one of these."""
    unlike: Annotated[list[Any] | None, BeforeValidator(_value), Field(alias="not")] = None
    """Equal to none of these."""
    ge: Limit | None = None
    """At least."""
    le: Limit | None = None
    """At most."""
    tol: Quantity | None = None
    """Absolute tolerance of `eq` and `in`, instead of the kind's."""
    given: bool | None = None
    """Whether there is a value at all."""
    or_none: bool = False
    """Whether a missing value is accepted, too: ``{eq: 0, or_none: true}`` accepts 0 and no value."""

    def relations(self) -> dict[str, Relation]:
        """Key → the relation under it."""
        return {
            name: value for name in ("eq", "about", "ge", "le") if isinstance(value := getattr(self, name), Relation)
        }

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> Any:
        """A bare value is allowed, too."""
        schema = handler.resolve_ref_schema(handler(core_schema))
        return {"anyOf": [schema, {"type": ["number", "string", "boolean", "array", "null"], **_LIMITS}]}

    @model_validator(mode="before")
    @classmethod
    def _from_value(cls, value: Any) -> Any:
        return value if isinstance(value, (dict, Match)) else {"eq": value}

    @model_validator(mode="after")
    def _says_something(self) -> Match:
        if not self.model_fields_set - {"tol", "or_none"}:
            raise ValueError("say which values are accepted: eq, about, in, not, ge, le or given")
        return self

    def words(self) -> str:
        """The accepted values, for people."""
        parts = []
        if "eq" in self.model_fields_set:
            parts.append(show(self.eq) + (f" ± {show(self.tol)}" if self.tol is not None else ""))
        if self.about is not None:
            parts.append(f"about {show(self.about)}")
        if self.among is not None:
            parts.append("one of " + ", ".join(map(show, self.among)))
        if self.unlike is not None:
            parts.append("not " + " or ".join(map(show, self.unlike)))
        if self.ge is not None and self.le is not None:
            parts.append(f"{show(self.ge)} to {show(self.le)}")
        elif self.ge is not None:
            parts.append(f"at least {show(self.ge)}")
        elif self.le is not None:
            parts.append(f"at most {show(self.le)}")
        if self.given is not None:
            parts.append("any" if self.given else "none")
        return " and ".join(parts) + (" or none" if self.or_none else "")


def fitting(
    said: dict[str, Match], kinds: Mapping[str, Kind], words: Mapping[str, Collection[str]], others: Kind = "name"
) -> dict[str, Match]:
    """Accepted values by name as they are, if each can be a value of its kind and, where words are known, one of them.

    Raises:
        ValidationError: A word is misspelt, or a text is not a number; with its place.
    """
    wrong: list[tuple[Place, PydanticCustomError]] = []
    for name, match in said.items():
        kind, known = kinds.get(name, others), words.get(name, ())
        given: list[tuple[Place, Any]] = [((name, key), getattr(match, key)) for key in ("eq", "about")]
        for key, values in (("in", match.among), ("not", match.unlike)):
            given += [((name, key, k), value) for k, value in enumerate(values or ())]
        for place, value in given:
            texts = [one for one in (value if isinstance(value, list) else [value]) if isinstance(one, str | bool)]
            if kind == "name":
                if known and isinstance(value, str) and value not in known and not value.startswith("#"):  # a color
                    wrong.append((place, unknown(name, value, known)))
            elif kind == "flag" and not isinstance(value, bool | None):
                wrong.append((place, problem("wrong-type", f"{name} is true or false", allowed=["true", "false"])))
            elif kind != "flag" and texts:
                message = f"{texts[0]!r} is not a number with a known unit"
                wrong.append((place, problem("invalid-value", message, allowed=[unit for unit in UNITS if unit])))
    if wrong:
        raise problems_at("values", wrong)
    return said


def checked(kinds: Mapping[str, Kind], words: Mapping[str, Collection[str]]) -> AfterValidator:
    """Metadata of accepted values by name, which must be fitting."""
    return AfterValidator(lambda said: fitting(said, kinds, words))


def matches(match: Match, value: Any, kind: Kind) -> bool:
    """Whether a value is accepted. A missing value (None) is accepted only by ``given: false``, ``eq: null`` and
    ``or_none``."""
    missing = value is None or value == []
    if match.or_none and missing:
        return True
    if match.given is not None and match.given == missing:
        return False
    if match.given is False or ("eq" in match.model_fields_set and match.eq is None):
        return missing
    slack = 1e-9 if kind == "count" else 1e-6

    def same(wanted: Any) -> bool:
        return _same(value, wanted, kind, match.tol)

    return (
        value is not None
        and ("eq" not in match.model_fields_set or same(match.eq))
        and (match.about is None or _near(value, match.about))
        and (match.among is None or any(map(same, match.among)))
        and (match.unlike is None or not any(map(same, match.unlike)))
        and (match.ge is None or (_is_number(value) and value >= match.ge - slack))
        and (match.le is None or (_is_number(value) and value <= match.le + slack))
    )


def show(value: Any) -> str:
    """A value for people: short numbers, lists in brackets."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(show, value)) + "]"
    return str(value)


def _is_number(value: Any) -> bool:
    return is_number(value) and not math.isnan(value)


def _same(value: Any, wanted: Any, kind: Kind, tol: float | None) -> bool:
    if isinstance(wanted, (list, tuple)):
        return (
            isinstance(value, Sequence)
            and not isinstance(value, str)
            and len(value) == len(wanted)
            and all(_same(a, b, kind, tol) for a, b in zip(value, wanted, strict=True))
        )
    if not (_is_number(value) and _is_number(wanted)):
        return bool(type(value) is type(wanted) and value == wanted)
    relative, absolute = TOLERANCES.get(kind, (0.0, 0.0))
    allowed = max(relative * abs(wanted), absolute) if tol is None else tol
    apart = abs(value - wanted)
    if kind == "heading":
        apart = abs(wrap(value - wanted))
    elif kind == "axis":  # a direction and its opposite are the same axis
        apart = abs(wrap(2 * (value - wanted))) / 2
    return bool(apart <= allowed + 1e-9)


def _near(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, (list, tuple)):
        return len(value) == len(wanted) and all(map(_near, value, wanted))
    return _is_number(value) and bool(abs(value - wanted) <= _ROUGHLY * abs(wanted) + 1e-9)
