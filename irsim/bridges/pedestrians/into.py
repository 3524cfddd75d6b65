"""Recorded pedestrians in a scene that exists: its file with one more entry, and what there is to say about both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely
from shapely.affinity import rotate as turned
from shapely.affinity import translate

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.scenario import Layout, check_size, checked, people_lines
from irsim.bridges.pedestrians.tracks import Track
from irsim.common.arrays import Floats
from irsim.common.text import clean, listed, plural, quoted, seconds
from irsim.episodes.scene_summary import called
from irsim.navigation.clearances import standing_distance
from irsim.objects.view import ObjectView
from irsim.objects.views import views
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import load_path, load_text
from irsim.scenario.yaml.entries import add_entry
from irsim.simulation.simulation import Simulation

__all__ = ["Merged", "merge"]

_SPACING = 0.1
"""Largest distance between two places of a path at which it is compared with the scene [m]."""
_TOUCHING = 0.02
"""Overlaps up to this depth count as touching [m]."""
_NAMED = 4
"""Number of people, robots or obstacles that a note names."""


@dataclass(frozen=True)
class Merged:
    """A scene with people in it.

    Attributes:
        text: The scenario.
        tracks: The pedestrians, as they are called in it.
        step_time: Of its world [s].
        notes: Remarks for the user.
    """

    text: str
    tracks: list[Track]
    step_time: float
    notes: list[str]


@dataclass(frozen=True)
class _Path:
    """Where a pedestrian is, close enough together for comparisons.

    Attributes:
        name: Of the pedestrian.
        times: (P,) [s].
        places: (P, 2) x, y [m].
    """

    name: str
    times: Floats
    places: Floats


def merge(scene: Path, target: Path, tracks: Sequence[Track], layout: Layout) -> Merged:
    """Add pedestrians to a scene as an entry of ``obstacle``; world, robots, obstacles and comments stay as they are.

    Args:
        scene: The scenario.
        target: File that the result is written to: files that the scenario names are looked for beside it.
        tracks: The pedestrians, in the frame of the scene.
        layout: Their radius and interpolation.

    Raises:
        ScenarioError: The scenario has errors.
        BridgeError: Nothing can be added to its text, no pedestrian would be in its world, or it would be too large.
    """
    document = load_path(scene)
    scenario = or_raise(read(document, strict=False))[0]
    taken = {record.name for record in scenario.objects}
    people = [replace(track, name=_free_name(track.name, taken)) for track in tracks]
    outside = [_outside(track, scenario) for track in people]
    if all(share == 1 for share in outside):
        raise BridgeError("bridge-file", _elsewhere(people, scenario), "move the recording with --offset and --rotate")
    check_size(people)
    group = 1 + max((record.group for record in scenario.objects), default=-1)
    _, first, *others = [line[4:] for line in people_lines(people, layout)]
    entry = [f"{first}  # recorded by {clean(layout.source)}", f"group: {group}", *others]
    text = add_entry(document.text or "", "obstacle", entry, prefix=document.prefix, limits=document.limits)
    if text is None:
        what = f"nothing can be added to 'obstacle' of {quoted(scene.name)} without a change of something else"
        raise BridgeError("bridge-file", what, "write 'obstacle' as a list with a line for each entry, without anchors")
    after = read(load_text(checked(text), scene.name, path=str(target)), strict=False)
    if after.scenario is None:
        error = next(item for item in after.diagnostics if item.severity == "error")
        what = f"with people in it, {quoted(target.name)} would have an error: {error.message}"
        raise BridgeError("bridge-file", what, f"write it beside {quoted(scene.name)}, whose files it needs")
    notes = [*_renamed(tracks, people), *_leaving(people, outside), *_too_late(people, scenario)]
    notes += _meetings(Simulation(after.scenario, [0], crowded=True), people, layout.radius)
    return Merged(text, people, float(scenario.world.step_time), notes)


def _free_name(name: str, taken: set[str]) -> str:
    """A free name, which is then taken."""
    free, number = name, 2
    while free in taken:
        free, number = f"{name}_{number}", number + 1
    taken.add(free)
    return free


def _renamed(tracks: Sequence[Track], people: Sequence[Track]) -> list[str]:
    pairs = [f"{old.name} is {new.name}" for old, new in zip(tracks, people, strict=True) if old.name != new.name]
    return [f"names that the scene has already: {listed(pairs, _NAMED)}"] if pairs else []


def _outside(track: Track, scenario: ResolvedScenario) -> float:
    """Share of the places of a pedestrian that are outside of the world."""
    x0, y0, x1, y1 = scenario.world.bounds
    (x, y) = track.places.T
    return float(((x < x0) | (x > x1) | (y < y0) | (y > y1)).mean())


def _elsewhere(people: Sequence[Track], scenario: ResolvedScenario) -> str:
    places = np.concatenate([track.places for track in people])
    recorded = _span(places.min(axis=0), places.max(axis=0))
    x0, y0, x1, y1 = scenario.world.bounds
    return f"no pedestrian is in the world of the scene: they walk in {recorded}, and it is {_span((x0, y0), (x1, y1))}"


def _span(low: Sequence[float] | Floats, high: Sequence[float] | Floats) -> str:
    return f"x {low[0]:.1f} to {high[0]:.1f} m, y {low[1]:.1f} to {high[1]:.1f} m"


def _leaving(people: Sequence[Track], outside: Sequence[float]) -> list[str]:
    gone = [track.name for track, share in zip(people, outside, strict=True) if share > 0]
    what = f"{len(gone)} of {len(people)} are outside of the world for a part of their time: {listed(gone, _NAMED)}"
    return [f"{what}; --crop leaves that part out"] if gone else []


def _too_late(people: Sequence[Track], scenario: ResolvedScenario) -> list[str]:
    last, limit = max(float(track.times[-1]) for track in people), scenario.world.time_limit
    if limit is None or limit >= last:
        return []
    late = sum(float(track.times[0]) > limit for track in people)
    missed = f", so that {late} of {len(people)} never come" if late else ""
    return [f"world.time_limit is {seconds(limit)}, and the recording ends after {seconds(last)}{missed}"]


def _meetings(simulation: Simulation, people: Sequence[Track], radius: float) -> list[str]:
    """Who walks through something that stands, and whose start lies on a pedestrian's path."""
    named = {view.name: view for view in views(simulation)}
    paths, names = [_path(track) for track in people], {track.name for track in people}
    drawn = {index for placement in simulation.scenario.placements for index in placement.objects}
    records, through, things = simulation.scenario.objects, list[str](), dict[str, None]()
    for path in paths:
        poses = np.column_stack([path.places, np.zeros(len(path.places))])
        distances, partners = standing_distance(simulation, named[path.name], poses)
        inside = np.flatnonzero(distances < -_TOUCHING)
        if inside.size:
            hit = [called(simulation.scenario, records[i].name) for i in dict.fromkeys(partners[inside].tolist())]
            through.append(f"{path.name} through {hit[0]} at {seconds(float(path.times[inside[0]]))}")
            things.update(dict.fromkeys(hit))
    notes = []
    if through:
        what = f"{len(through)} of {len(people)} walk through walls or obstacles: {listed(through, _NAMED)}"
        notes.append(f"{what}; in the way: {listed(list(things), _NAMED)}")
    for view in views(simulation):
        movable = view.role == "robot" or not view.record.static
        if movable and view.name not in names and view.record.id not in drawn and not view.record.recorded:
            notes += _start_on_path(view, paths, radius)
    return notes


def _start_on_path(view: ObjectView, paths: Sequence[_Path], radius: float) -> list[str]:
    """A note if a pedestrian walks over the place at which an object starts."""
    x, y, heading = view.init_state[:3, 0].tolist()
    body = translate(turned(view.body.original_geometry, heading, (0, 0), use_radians=True), x, y)
    met = []
    for path in paths:
        room = shapely.distance(shapely.points(path.places), body) - radius
        if room.min() < 0:
            met.append(f"{path.name} at {seconds(float(path.times[int(np.argmax(room < 0))]))}")
    if not met:
        return []
    what = f"{view.role} {quoted(view.name)} starts on the recorded path of {plural(len(met), 'pedestrian')}"
    return [f"{what}: {listed(met, _NAMED)}"]


def _path(track: Track) -> _Path:
    """Places of a pedestrian that are at most :data:`_SPACING` apart."""
    lengths = np.hypot(*np.diff(track.places, axis=0).T)
    counts = np.maximum(1, np.ceil(lengths / _SPACING)).astype(int)
    legs = np.repeat(np.arange(len(counts)), counts)
    shares = np.arange(len(legs)) - np.repeat(np.cumsum(counts) - counts, counts)
    places_in_rows = np.append(legs + shares / counts[legs], len(track.times) - 1.0)
    rows = np.arange(len(track.times))
    places = np.column_stack([np.interp(places_in_rows, rows, track.places[:, axis]) for axis in (0, 1)])
    return _Path(track.name, np.interp(places_in_rows, rows, track.times), places)
