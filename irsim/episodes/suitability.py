"""Which policy suits a scene: compares the scene with the card of each policy, and says why one does not fit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from irsim.common.text import clean, plural
from irsim.diagnostics.diagnostic import Diagnostic, Path, suggestion
from irsim.episodes.scene_facts import Scene
from irsim.policies.catalog import UnknownPolicyError, policy_names
from irsim.policies.scene_cards import SCENE_CARDS, OptionValues, SceneCard
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = [
    "UNSUITED",
    "Misfit",
    "Suited",
    "check_policy_name",
    "law_findings",
    "misfits_of",
    "suited_policies",
    "unsuited",
]

UNSUITED = "policy-unsuited"
"""Code of the warning about a policy outside its card."""
_CANNOT, _OTHER_KIND, _FURTHER = 3, 2, 1
"""How far a scene is from a card: the policy cannot drive there; the scene has what the card does not; a number lies
outside of the range of the card."""


@dataclass(frozen=True)
class Misfit:
    """One way in which a scene lies outside the card of a policy.

    Attributes:
        about: Its subject, in a word or two.
        weight: 1 for a number out of range, 2 for something that the card does not have, 3 for what cannot drive.
        reason: The words of the card, and the fact of the scene.
        given: The fact of the scene.
        allowed: The bound, or the words, of the card.
    """

    about: str
    weight: int
    reason: str
    given: float | str
    allowed: str


@dataclass(frozen=True)
class Suited:
    """How well a policy suits a scene.

    Attributes:
        policy: Name of the policy.
        origin: ``trained`` or ``law``.
        fits: ``yes``, ``partly`` (numbers out of range), ``no`` (outside), or ``cannot`` (it does not drive there).
        reason: Why, in a sentence.
        misfits: All ways in which the scene lies outside of its card.
        line: How a scenario, or a command for a trained policy, names it.
    """

    policy: str
    origin: str
    fits: str
    reason: str
    line: str
    misfits: list[Misfit] = field(default_factory=list)


def misfits_of(card: SceneCard, scene: Scene) -> list[Misfit]:
    """All ways in which a scene lies outside the card of a policy, the worst first."""
    misfits = [*_of_robots(card, scene), *_of_surroundings(card, scene), *_of_numbers(card, scene)]
    return sorted(misfits, key=lambda one: -one.weight)


def _of_robots(card: SceneCard, scene: Scene) -> Iterator[Misfit]:
    drives = Counter(str(getattr(one.kinematics, "name", "")) for one in scene.robots)
    others = [name for name in drives if card.drives is not None and name not in card.drives]
    if others and card.drives is not None:
        allowed = ", ".join(card.drives)
        yield Misfit("drives", _CANNOT, f"drives {allowed}; this scene has {', '.join(others)}", others[0], allowed)
    if card.lidar is not None:
        without = [one.name for one in scene.robots if not any(hasattr(s, "range_max") for s in one.sensors)]
        if without:
            lidar = yaml_flow(card.lidar)
            yield Misfit("lidar", _CANNOT, f"needs a lidar, which {without[0]!r} does not have", without[0], lidar)


def _of_surroundings(card: SceneCard, scene: Scene) -> Iterator[Misfit]:
    made = "was trained" if card.origin == "trained" else "is made"
    count = len(scene.static)
    if card.static == "none" and card.origin == "law":
        yield from _in_the_way(scene)
    elif card.static == "none" and (count or scene.has_map):
        seen = "a map" if scene.has_map else plural(count, "static obstacle")
        yield Misfit(
            "static",
            _OTHER_KIND,
            f"{made} without static obstacles; this scene has {seen}",
            seen,
            "no static obstacles",
        )
    elif card.static == "nearby" and (scene.has_map or scene.walls_between):
        seen = "a map" if scene.has_map else plural(scene.walls_between, "wall")
        what = f"plans no way; this scene has {seen}" + (" between a start and its goal" if not scene.has_map else "")
        yield Misfit("walls", _OTHER_KIND, what, seen, "what stands alone")
    if not card.movers and (scene.people or len(scene.robots) > 1):
        seen = plural(len(scene.people) + len(scene.robots) - 1, "other")
        yield Misfit(
            "movers", _OTHER_KIND, f"avoids nothing that moves; {seen} move in this scene", seen, "a robot alone"
        )
    elif not card.unyielding and scene.unyielding:
        count = len(scene.unyielding)
        what = f"{made} for people who give way; {count} in this scene do not"
        yield Misfit("unyielding", _OTHER_KIND, what, count, "people who give way")
    arrival = scene.scenario.world.after_arrival
    if card.arrival is not None and arrival not in (None, card.arrival) and len(scene.robots) > 1:
        what = f"{made} with after_arrival: {card.arrival}; this scene has {arrival}"
        yield Misfit("arrival", _FURTHER, what, str(arrival), card.arrival)


def _in_the_way(scene: Scene) -> Iterator[Misfit]:
    """Things that stand, or may stand, where a law that avoids nothing drives straight on."""
    what = ""
    if scene.has_map:
        what = seen = "a map"
    elif scene.static_on_ways:
        seen = plural(scene.static_on_ways, "static obstacle")
        what = f"{seen} on its straight ways"
    elif scene.drawn_static:
        seen = plural(scene.drawn_static, "static obstacle")
        what = f"{seen} at places that each seed draws"
    if what:
        yield Misfit("static", _OTHER_KIND, f"avoids nothing; this scene has {what}", seen, "free straight ways")


def _of_numbers(card: SceneCard, scene: Scene) -> Iterator[Misfit]:
    verb = "was trained with" if card.origin == "trained" else "is made for"
    for name, (low, high), (least, most), unit in (
        ("robots", card.robots, (len(scene.robots),) * 2, ""),
        ("moving obstacles", card.people, (len(scene.people),) * 2, ""),
        ("robots and people on 100 m2", (0.0, card.crowding), (scene.crowding,) * 2, ""),
        ("robots of a radius", card.radius, scene.radii, " m"),
        ("a top speed", card.speed, scene.speeds, " m/s"),
        ("straight ways", (0.0, card.way), (scene.longest_way,) * 2, " m"),
    ):
        if least >= low - 1e-9 and most <= high + 1e-9:
            continue
        value, none = most if most > high else least, high == 0
        within = f"{low:g}" if low == high else f"{low:g} to {high:g}" if low else f"at most {high:g}"
        allowed = f"no {name}" if none else within + unit
        noun = name.removesuffix("s") if high == 1 else name
        card_says = allowed if none else f"{name} of {allowed}" if unit else f"{allowed} {noun}"
        what = f"{verb} {card_says}; this scene has {value:.3g}{unit}"
        yield Misfit(name, _OTHER_KIND if none or value > 2 * high else _FURTHER, what, round(value, 3), allowed)


def suited_policies(scenario: ResolvedScenario) -> list[Suited]:
    """All policies with a card, the best one for a scenario first."""
    scene = Scene(scenario)
    ranked: list[tuple[int, int, bool, int, Suited]] = []
    for name, card in SCENE_CARDS.items():
        misfits = misfits_of(card, scene)
        if card.remedy and [one.about for one in misfits] == ["unyielding"]:
            misfits, options = [], card.options | card.remedy
        else:
            options = None
        worst, others = misfits[0].weight if misfits else 0, card.favored != scene.kind
        one = _suited(name, card, misfits, scene, options)
        ranked.append((worst, sum(m.weight for m in misfits), others, card.order, one))
    return [one for *_, one in sorted(ranked, key=lambda item: item[:4])]


def _suited(
    name: str,
    card: SceneCard,
    misfits: list[Misfit],
    scene: Scene,
    options: OptionValues | None = None,
) -> Suited:
    fits = ("yes", "partly", "no", "cannot")[misfits[0].weight if misfits else 0]
    reason = "; ".join(one.reason for one in misfits[:2]) or _praise(card, scene, options)
    return Suited(name, card.origin, fits, reason, _line(name, card, options), misfits)


def _praise(card: SceneCard, scene: Scene, options: OptionValues | None) -> str:
    """Why a policy fits."""
    if options is not None:
        setting = ", ".join(f"{key}: {yaml_flow(value)}" for key, value in options.items())
        return f"with {setting} it manages among {len(scene.unyielding)} who do not give way"
    if card.origin == "trained":
        return f"was trained in scenes like this one; {card.cost}"
    around = {"none": "", "nearby": "avoids what stands nearby", "planned": "plans around walls and maps"}[card.static]
    others = "avoids others, also those who do not give way" if card.unyielding else "avoids others who give way"
    parts = [around, others if card.movers and (scene.people or len(scene.robots) > 1) else "", card.cost]
    return "; ".join(filter(None, parts)) or "drives straight, and nothing is in the way"


def _line(name: str, card: SceneCard, options: OptionValues | None) -> str:
    """How a scenario names a law, or a command a trained policy."""
    if card.origin == "law":
        return f"behavior: {yaml_flow({'name': name, **(card.options if options is None else options)})}"
    lidar = "" if card.lidar is None else f"  # its robots carry sensors: [{yaml_flow(card.lidar)}]"
    return f"irsim run FILE --policy {name}{lidar}"


def check_policy_name(policy: str) -> None:
    """Check that a policy has this name, without opening it.

    Raises:
        UnknownPolicyError: None has; the message names the nearest one.
    """
    if policy not in (known := policy_names()):
        fix = suggestion(policy, known, "irsim policies lists them")
        raise UnknownPolicyError(f"there is no policy {clean(policy)!r}", fix)


def unsuited(policy: str, scenario: ResolvedScenario, path: Path = ("robot",)) -> list[Diagnostic]:
    """The warning that a scenario lies outside the card of a trained policy; empty where it fits or has no card.

    Of laws, see :func:`law_findings`: a law is not limited to scenes of a training.

    Args:
        policy: Name of the policy.
        scenario: The scenario.
        path: Where the scenario names what the policy drives.
    """
    card = SCENE_CARDS.get(policy)
    if card is None or card.origin != "trained":
        return []
    misfits = misfits_of(card, Scene(scenario))
    if not misfits:
        return []
    message = f"the policy {policy!r} {'; and '.join(one.reason for one in misfits[:2])}"
    best = suited_policies(scenario)[0]
    return [
        Diagnostic(
            UNSUITED, "warning", path, message, given=misfits[0].given, allowed=misfits[0].allowed,
            fix=f"{best.policy} suits it better ({best.line}); irsim policies --for FILE compares all",
        )
    ]  # fmt: skip


def law_findings(scenario: ResolvedScenario) -> list[Diagnostic]:
    """A warning for each entry of robots whose law needs other options among people who do not give way."""
    scene, findings = Scene(scenario), dict[Path, Diagnostic]()
    for one in scene.robots if scene.unyielding else ():
        law = one.active_behavior
        card = SCENE_CARDS.get(str(getattr(law, "name", "")))
        if card is None or not card.remedy or {getattr(law, key) for key in card.remedy} - _defaults(law, card.remedy):
            continue
        setting = ", ".join(f"{key}: {yaml_flow(value)}" for key, value in card.remedy.items())
        count = len(scene.unyielding)
        path = (*one.path, "behavior" if one.group_behavior is None else "group_behavior")
        message = (
            f"{law.name!r} is made for people who give way; {count} in this scene {'does' if count == 1 else 'do'} not"
        )
        findings.setdefault(one.path, Diagnostic(
            UNSUITED, "warning", path, message, given=count, allowed="people who give way",
            fix=f"{setting} keeps more distance; irsim policies --for FILE compares all",
        ))  # fmt: skip
    return list(findings.values())


def _defaults(law: Any, keys: Iterable[str]) -> set[Any]:
    return {type(law).model_fields[key].default for key in keys}
