"""Checks groups and crowds: whether a behavior can drive its group, which one counts, and crowds that stop for good."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from irsim.components.behaviors.sfm import Sfm
from irsim.components.options import CustomOptions
from irsim.diagnostics.diagnostic import Edit
from irsim.options.registry import BEHAVIORS, CUSTOM_GROUP_BEHAVIORS
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.resolve.resolved import ObjectRecord


def check(context: Context) -> Iterator[Finding]:
    """Check each group, and crowds without one."""
    groups: dict[int, list[ObjectRecord]] = defaultdict(list)
    for record in context.entry_objects:
        groups[record.group].append(record)
    for group, members in groups.items():
        yield from _not_a_group_behavior(context, members)
        leader = members[0]
        if isinstance(leader.group_behavior, Sfm):
            yield from _social_groups(context, leader, leader.group_behavior, len(members))
        if leader.group_behavior is None:
            yield from _unused_behavior(context, group, members)
        elif leader.role == "robot":
            yield from _driven_obstacles(group, members)
    yield from _crowd_that_stops(context)


def _not_a_group_behavior(context: Context, members: list[ObjectRecord]) -> Iterator[Finding]:
    seen = set()
    for record in members:
        options: Any = record.group_behavior
        if options is None or isinstance(options, CustomOptions) or options.in_group or record.path in seen:
            continue
        if CUSTOM_GROUP_BEHAVIORS.has(getattr(record.kinematics, "name", None), options.name):
            continue
        seen.add(record.path)
        path = context.entry_path(record, "group_behavior")
        able = [f.name for f in BEHAVIORS.features() if getattr(f.options, "in_group", False)]
        yield error(
            "not-a-group-behavior",
            (*path, "name"),
            f"'{options.name}' decides for one object, not for a group",
            given=options.name,
            allowed=able,
            fix="write it under 'behavior'",
            carry_on=Edit("remove", (*record.path, "group_behavior")),
        )


def _social_groups(context: Context, leader: ObjectRecord, options: Sfm, size: int) -> Iterator[Finding]:
    """Social groups with an index of no member, or with a member of another social group."""
    seen: dict[int, tuple[int, int]] = {}
    for i, together in enumerate(options.social_groups or ()):
        for j, index in enumerate(together):
            path = (*context.entry_path(leader, "group_behavior"), "social_groups", i, j)
            if index >= size:
                numbers = "its only member is 0" if size == 1 else f"its members are 0 to {size - 1}"
                message = f"there is no member {index} in group {leader.group}: {numbers}"
                fix = f"remove {index}, or raise 'number'; indices count the members of the group from 0"
            elif index in seen:
                before = f"social_groups[{seen[index][0]}][{seen[index][1]}]"
                message = f"member {index} is named twice, first in {before}"
                fix = f"remove {index} here or there: a member walks with one social group only"
            else:
                seen[index] = i, j
                continue
            yield error(
                "bad-social-group",
                path,
                message,
                given=index,
                fix=fix,
                carry_on=Edit("remove", (*leader.path, "group_behavior")),
            )


def _unused_behavior(context: Context, group: int, members: list[ObjectRecord]) -> Iterator[Finding]:
    later = next((m for m in members if m.group_behavior is not None), None)
    if later is not None:
        yield hint(
            "group-behavior-unused",
            context.entry_path(later, "group_behavior"),
            f"group {group} takes the group behavior of its first member, '{members[0].name}', which has no such key: "
            "this one has no effect",
        )


def _driven_obstacles(group: int, members: list[ObjectRecord]) -> Iterator[Finding]:
    seen = set()
    for member in members:
        if member.role == "obstacle" and not member.static and member.path not in seen:
            seen.add(member.path)
            name = getattr(members[0].group_behavior, "name", "")
            yield warning(
                "group-drives-obstacle",
                member.path,
                f"this obstacle is in group {group}, so the robots' group behavior '{name}' drives it too",
                fix="write 'obstacle' as a list, or give it a 'group' of its own",
                edit=Edit("add", (*member.path, "group"), group + 1),
            )


_CROWD = 6
"""Number of people with a way to one goal, as obstacles, from which some are likely to touch."""


def _crowd_that_stops(context: Context) -> Iterator[Finding]:
    """One finding: people who walk by forces, in a world where a contact stops both for good."""
    world = context.scenario.world
    if world.collision_mode != "stop":
        return
    pushed = [record for record in context.entry_objects if _is_pushed(record)]
    people = [record for record in pushed if record.wander or record.loop]
    if len(people) < 2:
        people = [record for record in pushed if record.role == "obstacle"]
        if len(people) < _CROWD:
            return
    mode = "unobstructed" if any(record.role == "robot" for record in people) else "unobstructed_obstacles"
    given = "collision_mode" in (context.data.get("world") or {})
    yield hint(
        "crowd-stops",
        ("world", "collision_mode") if given else people[0].path,
        f"'{people[0].name}' and {len(people) - 1} more move by 'sfm', under which bodies touch now and then, and "
        "collision_mode: stop stops both for good: more and more of them stand still",
        given="stop" if given else None,
        fix=f"world.collision_mode: {mode}"
        + (" (robots stop as before)" if mode != "unobstructed" else "")
        + ", or behavior: {name: orca}",
        edit=Edit("replace" if given else "add", ("world", "collision_mode"), mode, safe=False),
    )


def _is_pushed(record: ObjectRecord) -> bool:
    """Whether an object walks by forces."""
    options: Any = record.active_behavior
    options = getattr(options, "local", options)
    if record.static or record.unobstructed or record.kinematics is None:
        return False
    return bool(getattr(options, "touches", False))
