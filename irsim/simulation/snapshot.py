"""A simulation as bytes, from which an equal simulation goes on bit for bit.

The bytes begin with a digest of the rest: the core would believe damaged numbers, and read where nothing is.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from irsim.common.hashing import digest
from irsim.diagnostics.errors import InputError

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["dump", "load", "load_simulation", "save_simulation"]

_PARTS = "parts"
_OWNER = "worlds"
_DIGEST = len(digest())
"""Length of the digest [bytes]."""


def save_simulation(simulation: Simulation) -> bytes:
    """The present state of all worlds: of the core, and of drives, behaviors, policies and sensors in Python.

    Raises:
        InputError: Something in Python cannot be saved; another program takes part.
    """
    if simulation.movers:
        raise InputError("a bridge takes part in the run", "take snapshots where no bridge is open")
    memory = {
        "ids": simulation.ids.tolist(),
        "scenario": _scenario(simulation),
        "mode": simulation.world.collision_mode,
        "reseeded": simulation._reseeded,
        "rng": simulation._rng,
        _PARTS: [part.memory() for part in _parts(simulation)],
        "state": simulation.state.save(),
    }
    return dump(memory, simulation, _OWNER)


def load_simulation(simulation: Simulation, data: bytes) -> None:
    """Continue from what :func:`save_simulation` returned for an equal simulation.

    Raises:
        InputError: It was another simulation: other objects, another number of worlds, another scenario.
    """
    memory = load(data, simulation, _OWNER)
    parts = list(_parts(simulation))
    same = memory["ids"] == simulation.ids.tolist() and memory["scenario"] == _scenario(simulation)
    if not same or len(memory[_PARTS]) != len(parts):
        raise _of_another()
    try:
        simulation.state.load(memory["state"])
    except ValueError as error:
        raise _of_another() from error
    simulation.world.collision_mode = memory["mode"]
    simulation._reseeded, simulation._rng = memory["reseeded"], memory["rng"]
    for part, remembered in zip(parts, memory[_PARTS], strict=True):
        part.recall(remembered)


def _scenario(simulation: Simulation) -> str:
    """A digest that tells scenarios apart, as they are written."""
    return digest(repr(simulation.scenario.document))


def _of_another() -> InputError:
    return InputError(
        "the snapshot is of other objects or of another scenario",
        "restore it in the environment that it was taken of, with the objects that it had then",
    )


def _parts(simulation: Simulation) -> Iterator[Any]:
    """Parts in Python that remember something from step to step."""
    for part in (simulation.drives, *simulation.decisions):
        if part is not None:
            yield part
    if simulation.measurements:
        for world in range(simulation.copies):
            for view in simulation.views(world):
                yield from (sensor for sensor in view.sensors if hasattr(type(sensor), "recall"))


def dump(value: Any, simulation: Simulation, owner: str) -> bytes:
    """Pickle a value; the simulation, its objects and its scenario are named, not copied.

    Args:
        value: The value.
        simulation: The simulation that it is a part of.
        owner: The owner of this memory, in words; :func:`load` refuses the memory of other things.

    Raises:
        InputError: Something in it cannot be pickled.
    """
    out = io.BytesIO()
    try:
        _Pickler(out, simulation).dump((owner, value))
    except (AttributeError, TypeError, pickle.PicklingError) as error:
        what = f"the memory of code in Python cannot be saved: {error}"
        raise InputError(what, "keep in behaviors, policies and sensors only what pickle can store") from error
    content = out.getvalue()
    return digest(content).encode() + content


def load(data: bytes, simulation: Simulation, owner: str) -> Any:
    """The value that :func:`dump` has pickled, with the objects of this simulation.

    Raises:
        InputError: It is damaged, or the value of another owner.
    """
    fix = "give what snapshot() has returned"
    try:
        content = data[_DIGEST:]
        if digest(content).encode() != data[:_DIGEST]:
            raise InputError("the snapshot is damaged", fix)
        kind, value = _Unpickler(io.BytesIO(content), simulation).load()
    except InputError:
        raise
    except Exception as error:  # damaged pickles raise errors of many types
        raise InputError(f"the snapshot cannot be read: {error}", fix) from error
    if kind != owner:
        raise InputError(f"the snapshot is of {kind}, not of {owner}", fix)
    return value


class _Pickler(pickle.Pickler):
    def __init__(self, out: io.BytesIO, simulation: Simulation) -> None:
        super().__init__(out, protocol=5)
        self._names: dict[int, Any] = {id(value): name for name, value in _shared(simulation).items()}

    def persistent_id(self, value: Any) -> Any:
        return self._names.get(id(value))


class _Unpickler(pickle.Unpickler):
    def __init__(self, data: io.BytesIO, simulation: Simulation) -> None:
        super().__init__(data)
        self._shared = _shared(simulation)

    def persistent_load(self, name: Any) -> Any:
        if name not in self._shared:
            raise _of_another()
        return self._shared[name]


def _shared(simulation: Simulation) -> dict[Any, Any]:
    """The values that both sides have, by name."""
    scenario = simulation.scenario
    shared: dict[Any, Any] = {"simulation": simulation, "world": simulation.world, "state": simulation.state}
    shared |= {"scenario": scenario, "settings": scenario.world}
    shared |= {("record", index): record for index, record in enumerate(scenario.objects)}
    for world, views in simulation._views.items():
        shared |= {("object", world, index): view for index, view in enumerate(views)}
    return shared
