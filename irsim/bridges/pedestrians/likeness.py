"""How alike foretold and recorded walks are: errors of places, contacts, distributions of speeds and distances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irsim.bridges.pedestrians.cases import Cases
from irsim.bridges.pedestrians.tracks import PERIOD
from irsim.common.arrays import Floats

__all__ = ["Likeness", "contacts", "displacement_errors", "earth_movers_distance", "likeness", "nearest", "speeds"]


@dataclass(frozen=True)
class Likeness:
    """How alike foretold walks are to the recorded ones.

    Attributes:
        cases: Number of walks.
        ade: Average displacement error: mean distance between foretold and recorded place, over 12 rows [m].
        fde: Final displacement error: the same in the last row [m].
        contacts: Share of walks in which the person overlaps another one in at least one row.
        speed: Earth mover's distance between the foretold speeds and the recorded ones [m/s].
        nearest: Earth mover's distance between the foretold distances to the nearest other and the recorded ones [m].
    """

    cases: int
    ade: float
    fde: float
    contacts: float
    speed: float
    nearest: float


def likeness(cases: Cases, places: Floats, radius: float) -> Likeness:
    """Compare foretold walks with the recorded ones.

    Args:
        cases: The people.
        places: (W, 12, 2) their foretold places [m].
        radius: Radius of each person [m].
    """
    ade, fde = displacement_errors(places, cases.truth)
    return Likeness(
        len(cases),
        ade,
        fde,
        contacts(cases, places, radius),
        earth_movers_distance(speeds(cases, places), speeds(cases, cases.truth)),
        earth_movers_distance(_known(nearest(cases, places)), _known(nearest(cases, cases.truth))),
    )


def displacement_errors(places: Floats, truth: Floats) -> tuple[float, float]:
    """Mean distance between (W, 12, 2) foretold and recorded places over all rows, and in the last row [m]."""
    error = np.linalg.norm(places - truth, axis=2)
    return float(error.mean()), float(error[:, -1].mean())


def speeds(cases: Cases, places: Floats) -> Floats:
    """(W * 12,) speeds between the rows of walks, from the last known place on [m/s]."""
    way = np.concatenate([cases.start[:, None], places], axis=1)
    result: Floats = (np.linalg.norm(np.diff(way, axis=1), axis=2) / PERIOD).ravel()
    return result


def nearest(cases: Cases, places: Floats) -> Floats:
    """(W, 12) distance between the middles of the person and of the nearest other [m]; infinity without one."""
    result = np.empty(places.shape[:2])
    for part, others in cases.parts():
        apart = np.linalg.norm(others[:, :, 1:] - places[part, None], axis=3)
        result[part] = np.where(np.isfinite(apart), apart, np.inf).min(axis=1, initial=np.inf)
    return result


def contacts(cases: Cases, places: Floats, radius: float) -> float:
    """Share of walks in which the person overlaps another one in at least one of 12 rows."""
    return float((nearest(cases, places) < 2 * radius).any(axis=1).mean())


def earth_movers_distance(first: Floats, second: Floats) -> float:
    """Least mean way by which values must move so that one sample becomes the other; samples may differ in size.

    It is the area between the two cumulative distributions.
    """
    first, second = np.sort(first), np.sort(second)
    values = np.sort(np.concatenate([first, second]))
    below = [np.searchsorted(one, values[:-1], side="right") / len(one) for one in (first, second)]
    return float(np.sum(np.abs(below[0] - below[1]) * np.diff(values)))


def _known(distances: Floats) -> Floats:
    result: Floats = distances[np.isfinite(distances)]
    return result
