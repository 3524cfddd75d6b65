"""The content of a suite file: scenarios, seeds, horizon, protocols and policies of a benchmark that people can cite.

::

    suite: my_crossings
    version: 1
    title: Two robots at a crossing
    scenarios:
      - name: crossing
        template: crossing              # or scenario: {world: …, robot: …}, or file: scene.yaml
        vary: {courier_speed: [0.6, 0.9]}  # parameters of the template, or paths such as robot[0].number
      - name: lidars                   # values that change together: a list of mappings
        template: crossing
        vary: [{beams: 91, range: 4}, {beams: 181, range: 8}]
        tags: [sensing]                 # a row of its own for all scenarios with this tag
    seeds: {first: 0, count: 100, full: 1000}
    steps: 500
    protocols: [freeze, yield]
    policies:
      orca: {name: orca, timeHorizon: 2}
      dash: dash
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_serializer, model_validator

from irsim.benchmarks.roles import COMPARED
from irsim.common.arguments import as_given
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, format_path, suggestion
from irsim.diagnostics.diagnostic import Path as Path_
from irsim.diagnostics.errors import CodedError
from irsim.options.units import MAX_WHOLE, Value
from irsim.options.units import Seconds as Seconds_
from irsim.results.run import EpisodeUntil
from irsim.scenario.file_kind import MOST_PROBLEMS, FileKind, explained
from irsim.scenario.limits import MAX_STEPS
from irsim.scenario.perturbation import Perturbation
from irsim.scenario.yaml.document import Document, load_path

__all__ = [
    "SUITES",
    "WRITTEN_SUITES",
    "Protocol",
    "Seeds",
    "Suite",
    "SuiteError",
    "SuiteScenario",
    "is_suite",
    "load_suite",
    "suite_error",
]

Protocol = Literal["as-written", "freeze", "yield"]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_.-]{0,63}$")]
Combined = dict[str, Annotated[list[Any], Field(min_length=1)]]
Listed = Annotated[list[Annotated[dict[str, Any], Field(min_length=1)]], Field(min_length=1)]
MAX_SCENARIOS = 200
"""Largest number of scenarios that a suite expands to, without its protocols."""
WRITTEN_SUITES = {
    "pedestrians_v1": "irsim bridge pedestrians-suite --eth ETH/obsmat.txt --hotel HOTEL/obsmat.txt --zara01 zara01.txt"
}
"""Published suite that is made of files which irsim does not ship → the command that writes it, as ``NAME.yaml``."""


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


class SuiteScenario(_Part):
    """One scenario, or a family of scenarios that differ in a few values."""

    name: Name
    """Name in the results; values that vary are appended to it, as in ``robots-25``."""
    template: str | None = None
    """Name of a bundled template; ``irsim templates`` lists them."""
    parameters: dict[str, Value] = {}
    """Values of parameters of the template."""
    scenario: dict[str, Any] | None = None
    """The scenario itself, as in a scenario file."""
    file: str | None = None
    """A scenario file, relative to the suite file."""
    vary: Combined | Listed = {}
    """Parameter of the template, or path of a key such as ``robot[0].number`` → values; each combination is a scenario.
    Or a list of mappings of keys to one value each, such as ``[{"robot[0].number": 2, "robot[1].number": 4}]``; each
    mapping is a scenario, so that values change together."""
    steps: Annotated[int, Field(ge=1, le=MAX_STEPS)] | None = None
    """Horizon of these scenarios in steps; null takes the suite's."""
    overrides: dict[str, Any] = {}
    """Path of a key → value in each of them, as ``overrides`` of the suite."""
    tags: list[Name] = []
    """Groups to which these scenarios belong, such as ``doorway``: the scenarios of each tag are summarised in a row
    of their own."""
    policies: dict[str, str | dict[str, Any]] = {}
    """Name or tag of robots → the policy that drives them, where several share a scene: ``compared`` stands for each
    policy that the suite compares, and a name of its policies means that one, as in ``{probe: compared, crowd:
    orca}``. ``others`` are the robots that no other entry has. Results then have metrics by role."""

    @model_serializer(mode="wrap")
    def _as_before(self, serialize: Callable[[SuiteScenario], dict[str, Any]]) -> dict[str, Any]:
        """The fields, but for new ones without a value, so that the hashes of older suites stay."""
        new = ("overrides", "tags", "policies")
        return {key: value for key, value in serialize(self).items() if value or key not in new}

    def variants(self) -> Iterator[dict[str, Any]]:
        """The values of each scenario of the family, by key, in order."""
        if isinstance(self.vary, list):
            yield from (dict(values) for values in self.vary)
        else:
            for chosen in itertools.product(*self.vary.values()):
                yield dict(zip(self.vary, chosen, strict=True))

    def varied(self) -> set[str]:
        """The keys whose values vary."""
        return set(self.vary) if isinstance(self.vary, dict) else {key for values in self.vary for key in values}

    @model_validator(mode="after")
    def _has_one_source(self) -> SuiteScenario:
        given = [key for key in ("template", "scenario", "file") if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(f"give exactly one of template, scenario and file, not {' and '.join(given) or 'none'}")
        if self.parameters and self.template is None:
            raise ValueError("parameters belong to a template; write values of a scenario where they belong")
        if self.policies and COMPARED not in self.policies.values():
            raise ValueError(f"policies must let some robots be driven by {COMPARED}, the policy that is compared")
        return self


class Seeds(_Part):
    """Seeds of the episodes: episode k has the seed ``first + k``."""

    first: Annotated[int, Field(ge=0, lt=2**53)] = 0
    """Seed of the first episode."""
    count: Annotated[int, Field(ge=1, le=100_000)] = 100
    """Number of episodes of each scenario and policy."""
    full: Annotated[int, Field(ge=1, le=100_000)] | None = None
    """Number of episodes with ``--full``; null is ``count``."""

    @model_validator(mode="after")
    def _full_is_more(self) -> Seeds:
        if self.full is not None and self.full < self.count:
            raise ValueError(f"full must be at least count ({self.count}), got {self.full}")
        return self


def _needs_little_with_like(schema: dict[str, Any]) -> None:
    """A file that is like another one needs no scenarios and policies of its own."""
    always = ["suite", "version", "title"]
    needed = schema.pop("required")
    schema |= {"required": always, "anyOf": [{"required": ["like"]}, {"required": needed}]}


class Suite(_Part):
    """A benchmark with a fixed protocol."""

    model_config = ConfigDict(json_schema_extra=_needs_little_with_like)

    suite: Name
    """Name of the suite; a bundled one has the name of its file."""
    like: Name | None = None
    """Name of a bundled suite whose keys count where this file does not give them; `overrides` of both count."""
    version: Annotated[int, Field(ge=1, le=MAX_WHOLE)]
    """Version of the suite: results of different versions are not comparable."""
    title: Annotated[str, Field(min_length=1, max_length=100)]
    """Its subject, in one line."""
    about: str = ""
    """Its purpose and origin, and how to read its results."""
    sources: list[str] = []
    """Papers and pages that the suite follows."""
    scenarios: Annotated[list[SuiteScenario], Field(min_length=1)]
    """The scenarios."""
    seeds: Seeds = Seeds()
    """Seeds of the episodes."""
    steps: Annotated[int, Field(ge=1, le=MAX_STEPS)] | None = None
    """Horizon in steps; in seconds it is this number times the ``step_time`` of the scenario, 0.1 s by default."""
    seconds: Annotated[Seconds_, Field(gt=0)] | None = None
    """Horizon in seconds, instead of ``steps``, for scenarios with several ``step_time``."""
    overrides: dict[str, Any] = {}
    """Path of a key → value in every scenario: ``{"world.contacts": swept, "robot[*].acce": [1, 4]}``, where ``[*]`` is
    each entry. The last key may be new."""
    protocols: Annotated[list[Protocol], Field(min_length=1)] = ["as-written"]
    """Robots that have arrived stand still (``freeze``), stay controlled so that they can make room (``yield``), or do
    what the scenario says (``as-written``). Each protocol is run on its own."""
    until: EpisodeUntil = "done"
    """When an episode ends before its horizon: when every robot has arrived or stopped, or already when one collides,
    which fails the episode in both cases."""
    policies: Annotated[dict[Name, str | dict[str, Any]], Field(min_length=1)]
    """Name in the results → policy that the suite compares, with its options: a behavior (``dash`` or ``{name: orca,
    timeHorizon: 2}``), ``as-written``, ``random``, a plug-in, or a file (``.npz``, ``.onnx``) relative to the suite
    file. Differences are to the first one."""
    others: dict[Name, str | dict[str, Any]] = {}
    """Further policies in the same form, which are run only where they are named. They are not part of the hash of
    the suite."""
    perturb: list[Perturbation] = []
    """How far starts, headings, speeds and departures may differ from the scenarios, drawn per seed, such as
    ``[{position: 0.1}]``."""
    density: str | None = None
    """Key of ``vary`` that charts show from left to right, such as ``robot[0].number``."""

    def horizon(self, step_time: float) -> int:
        """The horizon in steps of this period [s]."""
        if self.steps is not None:
            return self.steps
        assert self.seconds is not None  # one of both is given
        return round(self.seconds / step_time)

    @property
    def known_policies(self) -> dict[str, str | dict[str, Any]]:
        """All policies that the suite has a name for, whether it runs them by itself or not."""
        return self.policies | self.others

    @model_serializer(mode="wrap")
    def _as_before(self, serialize: Callable[[Suite], dict[str, Any]]) -> dict[str, Any]:
        """The fields, but for new ones without a value, so that the hashes of older suites stay."""
        new = ("overrides", "seconds", "like")
        return {key: value for key, value in serialize(self).items() if value or key not in new}

    @model_validator(mode="before")
    @classmethod
    def _like_another(cls, given: Any) -> Any:
        name = given.get("like") if isinstance(given, dict) else None
        if not isinstance(name, str):
            return given
        known = [one for one in SUITES.names() if one != given.get("suite")]
        if name not in known:
            fix = suggestion(name, known, "see irsim describe suites")
            raise ValueError(f"there is no bundled suite {name!r}; {fix}")
        base = load_path(SUITES.bundled(name)).data
        if base.get("like"):
            raise ValueError(f"{name!r} is itself like another suite: name {base['like']!r}")
        horizon = {"steps", "seconds"} if {"steps", "seconds"} & set(given) else set()
        kept = {key: value for key, value in base.items() if key not in horizon}
        own = given.get("overrides")
        overrides = {**base.get("overrides", {}), **own} if isinstance(own, dict) else base.get("overrides", {})
        return {**kept, **given, "overrides": overrides}

    @model_validator(mode="after")
    def _is_consistent(self) -> Suite:
        if (self.steps is None) == (self.seconds is None):
            raise ValueError("give either steps or seconds")
        names = [scenario.name for scenario in self.scenarios]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"two scenarios have the name {twice!r}")
        if len(set(self.protocols)) < len(self.protocols):
            raise ValueError("a protocol is listed twice")
        both = next((name for name in self.others if name in self.policies), None)
        if both is not None:
            raise ValueError(f"policies and others both have {both!r}")
        if self.density is not None and not any(self.density in one.varied() for one in self.scenarios):
            raise ValueError(f"density is {self.density!r}, which no scenario varies")
        return self


def label_of(value: Any) -> str:
    """A value as a part of the name of a scenario."""
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return re.sub(r"[^A-Za-z0-9.]+", "-", text).strip("-")[:24]


_FIX = "irsim describe suites lists the keys of a suite file and has an example"
_VARY = "a mapping of each key to a list of values, or a list of mappings, each of which is one scenario"
_POLICY = "the name of a behavior, or a mapping such as {name: orca, timeHorizon: 2}"


class SuiteError(CodedError, ValueError):
    """A suite file cannot be used; the message lists every problem."""

    def __init__(
        self,
        message: str,
        fix: str,
        code: str = "bad-suite",
        diagnostics: Sequence[Diagnostic] = (),
        *,
        allowed: Sequence[str] = (),
    ) -> None:
        self.diagnostics = list(diagnostics)
        super().__init__(code, message, fix, allowed=allowed)


def suite_error(path: Path | str, problems: Sequence[Diagnostic]) -> SuiteError:
    """The error of a suite file with these problems.

    Args:
        path: The suite file.
        problems: At least one problem.
    """
    texts = [_text(item, str(path), alone=len(problems) == 1) for item in problems[:MOST_PROBLEMS]]
    texts += [f"and {len(problems) - MOST_PROBLEMS} more"] if len(problems) > MOST_PROBLEMS else []
    fix = problems[0].fix if len(problems) == 1 else None
    return SuiteError(
        f"{clean(path, 200)} is not a valid suite: {'; '.join(texts)}",
        _FIX if not fix or _is_guess(fix) else fix,
        diagnostics=problems,
    )


def load_suite(word: str) -> tuple[Suite, Path]:
    """A suite, and the file that it was read from.

    Args:
        word: Name of a bundled suite, or path of a file.

    Raises:
        SuiteError: There is no such suite, or it is not valid.
    """
    known = SUITES.names()
    path = SUITES.bundled(word) if word in known else Path(word)
    if not path.is_file() and word in WRITTEN_SUITES:
        what = f"the suite {word} is made of recordings that you have, and irsim does not ship them"
        raise SuiteError(what, f"{WRITTEN_SUITES[word]} writes {word}.yaml; name that file", "unknown-suite")
    if not path.is_file():
        fix = suggestion(word, known, f"choose one of {', '.join(known)}, or give a file")
        raise SuiteError(f"there is no suite {clean(word)!r}", fix, "unknown-suite", allowed=known)
    return SUITES.read(load_path(path)), path


def is_suite(word: str) -> bool:
    """Whether a word names a suite: a published one, perhaps misspelt, or a YAML file with the key ``suite``."""
    return word in WRITTEN_SUITES or SUITES.is_named(word) or SUITES.is_file(word)


def _text(item: Diagnostic, path: str, *, alone: bool) -> str:
    """A problem as part of a sentence."""
    place = [] if item.file in (None, path) else [clean(item.file, 100)]
    place += [] if item.line is None else [f"line {item.line}"]
    text = item.message
    if not text.startswith("scenario ") and item.path:
        text = f"{clean(format_path(item.path), 100)}: {text}"
    if item.code == "unknown-value" and isinstance(item.allowed, Sequence) and not isinstance(item.allowed, str):
        text += f"; choose from {', '.join(map(str, item.allowed))}"
    if item.fix and _is_guess(item.fix):
        text += f", {item.fix}"
    elif item.fix and not alone:
        text += f" ({item.fix})"
    return f"{', '.join(place)}: {text}" if place else text


def _is_guess(fix: str) -> bool:
    return fix.startswith("did you mean")


def _explain(failure: ValidationError, document: Document, model: type[BaseModel]) -> list[Diagnostic]:
    """The problems of a validation, one for each key; a key with several forms is explained with these forms."""
    problems = explained(failure, document, model, lambda place: _special(place, document.data))
    return list({problem.path: problem for problem in reversed(problems)}.values())[::-1]


def _special(path: Path_, data: Any) -> Diagnostic | None:
    """The problem of a key whose value may have several forms, for which pydantic lists a problem of each form."""
    if path[:1] == ("policies",) and len(path) > 2 and path[2] != "[key]":
        return _error("wrong-type", path[:2], f"must be {_POLICY}, got {as_given(data['policies'][path[1]])}")
    if path[:1] != ("scenarios",) or len(path) < 4:
        return None
    scenario = data["scenarios"][path[1]]
    if path[2] == "parameters":
        given = as_given(scenario["parameters"][path[3]])
        return _error("wrong-type", path[:4], f"must be a number, true, false or text, got {given}")
    if path[2] != "vary":
        return None
    vary = scenario["vary"]
    if isinstance(vary, dict):
        for key, values in vary.items():
            if not isinstance(values, list) or not values:
                place = (*path[:3], str(key))
                return _error("wrong-type", place, f"must be a list of at least one value, got {as_given(values)}")
    if isinstance(vary, list):
        for number, values in enumerate(vary):
            if not isinstance(values, dict) or not values:
                place = (*path[:3], number)
                return _error("wrong-type", place, f"must be a mapping of keys to values, got {as_given(values)}")
    return _error("wrong-type", path[:3], f"must be {_VARY}, got {as_given(vary)}")


def _error(code: str, path: Path_, message: str) -> Diagnostic:
    return Diagnostic(code, "error", path, message)


SUITES = FileKind(
    key="suite",
    model=Suite,
    folder=Path(__file__).with_name("suites"),
    error=lambda document, problems: suite_error(document.name or "the suite", problems),
    explain=_explain,
)
"""Suite files."""
