"""The content of a case file: a prompt, and what must be true of an answer to it.

A text of the form ``$(expression)`` stands for a value of the case's parameters: one file yields many instances.
"""

from __future__ import annotations

import keyword
from inspect import cleandoc
from pathlib import PurePosixPath
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, create_model, model_validator

from irsim.diagnostics.diagnostic import is_slip_of
from irsim.options.base import problem, problems_at
from irsim_evals.cases.drawing import PICTURES, Drawing, Record
from irsim_evals.grader.matching import Quantity, Seeds
from irsim_evals.grader.predicates._base import Predicate, registered, stands_at_start
from irsim_evals.grader.relations import unknown_words
from irsim_evals.grader.selection import BUILT_IN, Selection, Selections, Selector
from irsim_evals.grader.words import BehaviorName, Listed, OneOf, Regex, unknown

__all__ = [
    "FACTS", "GROUPS", "WORLD_FACTS", "Assertion", "Case", "Disposition", "EpisodePlan", "Parameter", "Pin", "Waiver",
]  # fmt: skip

FACTS = (
    "count", "role", "kinematics", "shape", "size", "position", "heading", "goal", "goal_heading", "behavior",
    "options", "forward", "backward", "sideways", "turn", "steer", "acce", "sensor_count", "sensor_kind", "range",
    "beams", "opening", "sensor_options", "color", "name", "threshold", "passable", "wheelbase", "fov", "tags",
    "noise", "driven", "delays", "way", "random", "cover",
)  # fmt: skip
"""Kinds of facts of a body; ``driven`` is whether it has a behavior, ``delays`` when it comes into the world and starts
to move, ``way`` how its goals lie from its start, ``random`` whether its place is drawn, ``cover`` whether all that a
fixed body covered is covered still."""
GROUPS = {
    "pose": ("position", "heading"),
    "limits": ("forward", "backward", "sideways", "turn", "steer", "acce"),
    "sensors": ("sensor_count", "sensor_kind", "range", "beams", "opening", "sensor_options"),
}
"""Short names for several kinds of facts."""
WORLD_FACTS = ("size", "origin", "times", "modes", "map", "fog")
"""Kinds of facts of the world."""
OTHER_FACTS = {
    "world": (*WORLD_FACTS, "mirror_x", "mirror_y"),
    "reply": ("reply", "replies"),
    "text": ("comments", "layout"),
}
"""Subject that is not a selection of bodies → its facts; a mirror is a fact that can only be free."""

Disposition = Literal["build", "ask", "flag"]
Positive = Annotated[float, Field(gt=0, le=1e6)]


class Parameter(Record):
    """A value that differs from instance to instance."""

    default: bool | int | float | str
    """Its value in the case as published."""
    choose: Annotated[list[Any], Field(min_length=1)] | None = None
    """Values that an instance draws from."""
    between: tuple[Quantity, Quantity] | None = None
    """Range that an instance draws from."""
    step: Positive = 0.1
    """Values from a range are multiples of this."""

    @model_validator(mode="after")
    def _one(self) -> Parameter:
        if (self.choose is None) == (self.between is None):
            raise ValueError("give either `choose` or `between`")
        return self


class _AssertionBase(Record):
    id: str
    """Name of the assertion, unique in the case."""
    when: Literal["always", "built", "unbuilt"] | None = None
    """Whether it counts only if there is a scenario, or only if there is not; default: with a scenario if it is about
    the world, else always."""
    file: str = ""
    """Scenario that an assertion about the start is about, where an answer has several; default: the main one."""

    @property
    def predicate(self) -> Predicate:
        """Its predicate."""
        chosen: Predicate = next(
            value for name in registered() if (value := getattr(self, _attribute(name))) is not None
        )
        return chosen

    @model_validator(mode="after")
    def _one_predicate(self) -> Any:
        given = [name for name in registered() if getattr(self, _attribute(name)) is not None]
        if len(given) != 1:
            said = " and ".join(given) or "none"
            fix = "make each of them an item of the list, with an id of its own" if given else None
            message = f"give exactly one predicate, not {said}"
            raise problem("invalid-value", message, allowed=list(registered()), fix=fix)
        return self


def _attribute(name: str) -> str:
    return f"{name}_" if keyword.iskeyword(name) else name


_predicates: dict[str, Any] = {
    _attribute(name): (predicate | None, Field(default=None, alias=name, description=cleandoc(predicate.__doc__ or "")))
    for name, predicate in registered().items()
}
Assertion: Any = create_model("Assertion", __base__=_AssertionBase, **_predicates)


def _in_its_place(of_episode: bool) -> AfterValidator:
    """A check that an assertion about an episode is under ``episodes``, and one about something else is not."""

    def check(assertion: Any) -> Any:
        name, subject = assertion.predicate.name, assertion.predicate.subject
        fits = subject == "episode" if of_episode else stands_at_start(assertion.predicate)
        if not fits:
            where = "assert" if of_episode else "assert of an item of episodes"
            what = "an episode" if subject == "episode" else "the start or the answer"
            raise problem("invalid-value", f"{name!r} is about {what}", fix=f"move it to the key {where}")
        return assertion

    return AfterValidator(check)


OfStart = Annotated[Assertion, _in_its_place(False)]
OfEpisode = Annotated[Assertion, _in_its_place(True)]


class EpisodePlan(Record):
    """Episodes that are simulated, and what must happen in each."""

    seeds: Seeds = [0]
    """One episode per seed."""
    seconds: Quantity
    """Simulated time [s]; an episode goes on after all robots have arrived."""
    share: Quantity = 1.0
    """Share of the episodes in which each assertion must hold."""
    behavior: BehaviorName | None = None
    """Behavior that drives the robots instead of theirs, as ``irsim run --behavior`` does."""
    speed: dict[Selection, Quantity] = {}
    """Selection → factor of the speed limits of its bodies, such as 0.5 for half as fast."""
    check: Annotated[list[OfEpisode], Field(alias="assert")]
    """Assertions about each episode."""


_OF_BODIES = (*FACTS, *GROUPS)
PinnedName = Annotated[str, OneOf("selection", (*BUILT_IN, *OTHER_FACTS), own="selections")]
Fact = Annotated[
    str, OneOf("fact", tuple(dict.fromkeys((*_OF_BODIES, *(f for own in OTHER_FACTS.values() for f in own)))))
]


class Pin(Record):
    """Facts that a prompt pins or leaves free, for the proof of the grader."""

    of: PinnedName = "all"
    """Selection of the bodies; ``world`` for the world itself, ``reply`` and ``text`` for the words of the answer."""
    facts: Annotated[list[Fact], Listed()]
    """Facts, such as ``size``, ``pose``, ``limits`` and ``sensors``, which stand for several, ``way`` (from start to
    goal) and ``cover`` (of what is fixed: it may grow, not shrink or move). The guide has the facts of each ``of``."""
    why: str = ""
    """Reason, where it is not plain from the prompt."""

    @model_validator(mode="after")
    def _of_its_kind(self) -> Pin:
        known = OTHER_FACTS.get(self.of, _OF_BODIES)
        for fact in self.facts:
            if fact not in known:
                raise problem("unknown-value", f"{fact!r} is not a fact of {self.of}", allowed=known)
        return self


class Waiver(Record):
    """Mutants that change a pinned fact and are right all the same."""

    operator: str
    """Name of the operator that makes them."""
    what: Regex = ""
    """Regular expression that what was changed contains."""
    why: str
    """Reason."""


def _missing(name: str) -> str:
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or path.suffix.lower() not in PICTURES:
        raise ValueError(f"missing: {name!r} is not the path of a picture in the folder ({', '.join(PICTURES)})")
    return name


Missing = Annotated[str, AfterValidator(_missing)]
CATEGORIES = (
    "basic", "geometry", "units", "kinematics", "multi", "sensors", "maps", "social", "rl", "bench", "edit", "i18n",
    "ambiguous", "impossible", "adversarial", "planning", "recovery",
)  # fmt: skip
"""Abilities that cases test; a case may have others, too."""


def _category(word: str) -> str:
    if word not in CATEGORIES and any(is_slip_of(word, one) for one in CATEGORIES):
        raise unknown("category", word, CATEGORIES)
    return word


class Case(Record):
    """One case."""

    id: str
    """Name of the case; its file has the same name."""
    title: str
    """Its subject, in a few words."""
    family: str = ""
    """Cases of one family share a base, so their results are not independent; default: the case itself."""
    category: list[Annotated[str, AfterValidator(_category)]]
    """Abilities that it tests: some of :data:`CATEGORIES`, words of your own, or the skill whose task it is."""
    level: Annotated[int, Field(ge=1, le=4)]
    """1 is easy, 4 is hard."""
    language: str = "en"
    """Language of the prompt."""
    hard: str = ""
    """Why it is hard, for cases of level 4."""
    made: str = ""
    """How the prompt was made: who speaks, from which source, and what its writer had not seen."""
    prompt: str
    """The request to the agent."""
    wordings: list[str] = []
    """Other ways to ask for the same; a fresh instance draws one."""
    turns: list[str] = []
    """Messages of the user after each reply."""
    files: dict[str, str] = {}
    """Files that the folder starts with: name → text."""
    drawings: dict[str, Drawing] = {}
    """Pictures that the folder starts with: name → what is drawn."""
    missing: list[Missing] = []
    """Maps that the user names and only the user has, by their path in the folder: the answer keeps the path and
    invents no map, and is graded with an empty one."""
    scenario: bool = True
    """Whether the answer is a scenario; without it only files and the reply are looked at."""
    python: Literal["none", "runner", "any"] = "none"
    """Programs that the agent may leave: none, ones that only run scenarios, or any, which are run only where
    ``irsim-evals grade --run-programs`` says so."""
    disposition: list[Disposition] = ["build"]
    """Ways in which the agent may answer: build a scenario, ask first, or say that it cannot be done."""
    seeds: Seeds = [0]
    """Seeds of the worlds that assertions about the start look at."""
    passable: Selections = []
    """Selections of the bodies that others may pass through (``unobstructed``); all others must be solid."""
    late: Selections = []
    """Selections of bodies that never move and may come into the world after its start (``appear_time``)."""
    in_vain: bool = False
    """Whether the time limit may be too short for the way of every robot; episodes then go on beyond it."""
    overlap: bool = False
    """Whether bodies may overlap at the start; ``overlap_free`` then says how often."""
    parameters: dict[str, Parameter] = {}
    """Name → what an instance may change."""
    let: dict[str, str] = {}
    """Name → expression over parameters and names before it."""
    select: dict[str, Selector] = {}
    """Name → bodies that assertions speak of."""
    check: Annotated[list[OfStart], Field(alias="assert")] = []
    """Assertions about the world at its start, the files and the reply."""
    episodes: list[EpisodePlan] = []
    """Assertions about each episode."""
    pins: list[Pin] = []
    """Facts that the prompt pins: a change of one must be noticed."""
    free: list[Pin] = []
    """Facts that the prompt leaves free: a change of one must be accepted."""
    waived: list[Waiver] = []
    """Mutants that the proof leaves out, with reasons."""
    equivalent: str = ""
    """Other answers that are right, for reviewers."""

    def assertions(self) -> dict[tuple[int | str, ...], Any]:
        """Place in the file → assertion, those about episodes last."""
        lists: dict[tuple[int | str, ...], list[Any]] = {("assert",): self.check}
        lists |= {("episodes", k, "assert"): plan.check for k, plan in enumerate(self.episodes)}
        return {(*place, k): item for place, items in lists.items() for k, item in enumerate(items)}

    @model_validator(mode="after")
    def _fit_together(self) -> Case:
        wrong, taken, last = list[tuple[Any, Any]](), set[str](), 1 + len(self.turns)
        for place, item in self.assertions().items():
            if item.id in taken:
                message = f"an assertion before it is called {item.id!r}, too"
                wrong.append(((*place, "id"), problem("duplicate-name", message, fix="give one of them another id")))
            if item.predicate.name == "edits" and item.predicate.base not in self.files:
                wrong.append(((*place, "edits", "base"), unknown("file", item.predicate.base, list(self.files))))
            if isinstance(turn := getattr(item.predicate, "turn", None), int) and turn > last:
                late = problem("out-of-range", f"this turn is later than the last one, {last}", allowed=f"1 to {last}")
                wrong.append(((*place, item.predicate.name, "turn"), late))
            wrong += [((*place, *inner), error) for inner, error in unknown_words(item.predicate, self.select)]
            taken.add(item.id)
        if wrong:
            raise problems_at("case", wrong)
        return self
