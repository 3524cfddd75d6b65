"""One registry per kind of feature: YAML name → options model, and the kernel or function that computes it.

Built-in features are modules of a package, found by file name and imported on first use, so that a scenario imports
only what it needs. Plug-ins come through decorators or the entry-point group of the registry.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import BaseModel

from irsim.common.lazy import module_names

__all__ = [
    "BEHAVIORS",
    "BRIDGES",
    "CUSTOM_BEHAVIORS",
    "CUSTOM_GROUP_BEHAVIORS",
    "DISTRIBUTIONS",
    "KINEMATICS",
    "MAPS",
    "PLANNERS",
    "REGISTRIES",
    "SENSORS",
    "SHAPES",
    "CustomBehaviors",
    "Feature",
    "Registry",
    "is_built_in",
    "reading_order",
]


Pair = tuple[str, str]
"""Kinematics and name of a behavior."""


def is_built_in(made: object) -> bool:
    """Whether a class or a function is one of irsim, not of user code or a plug-in."""
    return getattr(made, "__module__", "").startswith("irsim.")


@dataclass(frozen=True)
class Feature:
    """A registered feature.

    Attributes:
        name: Its name in YAML.
        options: pydantic model of its keys; the docstring and field docstrings are its documentation.
        kernel: Class of the core that holds the same options for the native kernel, or None.
        function: Python function that computes it, or None.
        origin: ``"built-in"``, or the module of the plug-in that registered it.
    """

    name: str
    options: type[BaseModel]
    kernel: type[Any] | None = None
    function: Callable[..., Any] | None = None
    origin: str = "built-in"

    @property
    def simulated(self) -> bool:
        """Whether this version simulates the feature."""
        return self.kernel is not None or self.function is not None


class Registry:
    """Features of one kind, by YAML name.

    Args:
        kind: Singular word for messages: ``behavior``.
        package: Package whose modules are the built-in features, one module per name.
        group: Entry-point group of third-party features.
        best_known: Names that answers show before the others where several features have a key, best known first.
        families: Names of modules with several features each, if the package has such modules; they are imported
            together.
    """

    def __init__(
        self, kind: str, package: str, group: str, *, best_known: Sequence[str] = (), families: Sequence[str] = ()
    ) -> None:
        self.kind, self.package, self.group = kind, package, group
        self.best_known = tuple(best_known)
        self._families = tuple(families)
        self._features: dict[str, Feature] = {}
        self._plugins: dict[str, Any] | None = None

    def register(
        self,
        options: type[BaseModel],
        *,
        name: str | None = None,
        kernel: type[Any] | None = None,
        function: Callable[..., Any] | None = None,
    ) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
        """Register an options model under ``name``, by default the default of its ``name`` field.

        With neither ``kernel`` nor ``function`` the feature is part of the language but not simulated; the returned
        decorator then adds the Python function that computes it.

        Raises:
            ValueError: Another model already has the name.
        """
        name = str(options.model_fields["name"].default) if name is None else name
        known = self._features.get(name)
        if known is not None and known.options is not options:
            raise ValueError(f"{self.kind} {name!r} is already registered by {known.options.__module__}")
        origin = "built-in" if is_built_in(options) else options.__module__
        self._features[name] = Feature(name, options, kernel, function, origin)

        def add(computed_by: Callable[..., Any]) -> Callable[..., Any]:
            self._features[name] = replace(self._features[name], function=computed_by)
            return computed_by

        return add

    def replace(self, options: type[BaseModel], name: str, function: Callable[..., Any]) -> None:
        """Register a feature of user code, replacing an earlier one of that name.

        Raises:
            ValueError: A built-in feature has this name.
        """
        known = self.get(name)
        if known is not None and known.origin == "built-in":
            raise ValueError(f"{name!r} is a built-in {self.kind}; give yours another name")
        self._features[name] = Feature(name, options, None, function, options.__module__)

    def names(self) -> list[str]:
        """All names, sorted: built-in, registered, and offered by installed plug-ins."""
        return sorted({*self.installed(), *self._features})

    def installed(self) -> list[str]:
        """Names that exist in every process, sorted: built-in, and offered by installed plug-ins."""
        if self._families:
            self._import_families()
            builtin = [feature.name for feature in self._features.values() if feature.origin == "built-in"]
        else:
            builtin = [*module_names(self.package)]
        return sorted({*builtin, *self._plugin_entries()})

    def _import_families(self) -> None:
        for name in self._families:
            importlib.import_module(f"{self.package}.{name}")

    def get(self, name: str) -> Feature | None:
        """The feature, imported on first use; None if no feature has that name."""
        if name in self._features:
            return self._features[name]
        if self._families:
            self._import_families()
        elif name in module_names(self.package):
            importlib.import_module(f"{self.package}.{name}")
        if name not in self._features and name in self._plugin_entries():
            self._plugin_entries()[name].load()
        return self._features.get(name)

    def features(self) -> list[Feature]:
        """Every feature, sorted by name (imports all of them)."""
        return [feature for name in self.names() if (feature := self.get(name)) is not None]

    def _plugin_entries(self) -> dict[str, Any]:
        if self._plugins is None:
            from importlib.metadata import entry_points

            self._plugins = {entry.name: entry for entry in entry_points(group=self.group)}
        return self._plugins


class CustomBehaviors:
    """Behaviors that user code registered the 2.12 way: functions and classes by kinematics and name.

    A class (or any factory) is called once per object, or per group, and returns a callable for every step. Classes
    take precedence over functions, and both over the built-in behavior of that name.

    Args:
        kind: Singular word for messages: ``behavior``.
        functions_taken: Pairs of kinematics and name that are built in as functions.
        classes_taken: Pairs of kinematics and name that are built in as classes.
    """

    def __init__(self, kind: str, functions_taken: Iterable[Pair] = (), classes_taken: Iterable[Pair] = ()) -> None:
        self.kind = kind
        self.functions: dict[Pair, Callable[..., Any]] = {}
        self.classes: dict[Pair, Callable[..., Any]] = {}
        self._taken = frozenset(functions_taken), frozenset(classes_taken)

    def register(self, kinematics: str, name: str, function: Callable[..., Any]) -> None:
        """Register ``function`` as the behavior ``name`` of objects with these kinematics.

        Raises:
            ValueError: The name is taken, by a built-in behavior or by an earlier registration.
        """
        self._add(self.functions, self._taken[0], (kinematics, name), function)

    def register_class(self, kinematics: str, name: str, maker: Callable[..., Any]) -> None:
        """Register a class or another factory as the behavior ``name`` of objects with these kinematics.

        Raises:
            ValueError: The name is taken, by a built-in behavior or by an earlier registration.
        """
        self._add(self.classes, self._taken[1], (kinematics, name), maker)

    def _add(self, table: dict[Pair, Callable[..., Any]], taken: frozenset[Pair], key: Pair, value: Any) -> None:
        if key in taken:
            raise ValueError(f"{key[1]!r} is a built-in {self.kind} of {key[0]!r}; register yours under another name")
        if table.get(key, value) is not value:
            raise ValueError(f"{self.kind} {key[1]!r} is already registered for {key[0]!r}")
        table[key] = value

    def function(self, kinematics: str | None, name: str) -> Callable[..., Any] | None:
        """The function that user code has registered, or None."""
        key = (kinematics or "static", name)
        function = self.functions.get(key)
        return None if function is None or key in self._taken[1] or is_built_in(function) else function

    def maker(self, kinematics: str | None, name: str) -> Callable[..., Any] | None:
        """The class or factory that user code has registered, or None."""
        maker = self.classes.get((kinematics or "static", name))
        return None if is_built_in(maker) else maker

    def has(self, kinematics: str | None, name: str) -> bool:
        """Whether user code has registered anything for this kinematics and name."""
        return self.maker(kinematics, name) is not None or self.function(kinematics, name) is not None

    def _pairs(self) -> set[Pair]:
        return {pair for pair in {*self.functions, *self.classes} if self.has(*pair)}

    def names(self, kinematics: str | None = None) -> list[str]:
        """Names registered for these kinematics, sorted; without an argument, for any kinematics."""
        return sorted({name for drive, name in self._pairs() if kinematics in (None, drive)})

    def drives(self, name: str) -> list[str]:
        """Kinematics that have a behavior of that name, sorted."""
        return sorted(drive for drive, known in self._pairs() if known == name)


BEHAVIORS = Registry(
    "behavior", "irsim.components.behaviors", "irsim.behaviors", best_known=("dash", "orca", "rvo", "sfm", "follow")
)
BRIDGES = Registry("bridge", "irsim.components.bridges", "irsim.bridges", best_known=("ros2",))
DISTRIBUTIONS = Registry(
    "distribution", "irsim.components.distributions", "irsim.distributions", best_known=("random",)
)
KINEMATICS = Registry(
    "kinematics", "irsim.components.kinematics", "irsim.kinematics", best_known=("diff", "omni", "acker")
)
MAPS = Registry("map", "irsim.components.maps", "irsim.maps", best_known=("image",))
PLANNERS = Registry(
    "planner", "irsim.components.planners", "irsim.planners", best_known=("astar",), families=("grid", "sampling")
)
SENSORS = Registry("sensor", "irsim.components.sensors", "irsim.sensors", best_known=("lidar2d", "imu", "odometry"))
SHAPES = Registry(
    "shape", "irsim.components.shapes", "irsim.shapes", best_known=("circle", "rectangle", "polygon", "linestring")
)

CUSTOM_BEHAVIORS = CustomBehaviors(
    "behavior",
    functions_taken=[
        *((drive, name) for drive in ("diff", "omni") for name in ("dash", "rvo", "sfm")),
        ("omni_angular", "dash"),
        ("acker", "dash"),
    ],
)
CUSTOM_GROUP_BEHAVIORS = CustomBehaviors(
    "group behavior", classes_taken=[(drive, name) for drive in ("diff", "omni") for name in ("orca", "sfm")]
)

REGISTRIES = {
    registry.kind: registry
    for registry in (BEHAVIORS, SHAPES, KINEMATICS, SENSORS, DISTRIBUTIONS, MAPS, PLANNERS, BRIDGES)
}


def reading_order(place: str) -> tuple[int, int, int]:
    """Sort key of places of one name: shallow ones first, then the components that are best known, then short ones.

    Args:
        place: Words joined by dots, such as ``robot.sensors.lidar2d.range_max``.
    """
    words = place.split(".")
    known = [name for registry in REGISTRIES.values() for name in registry.best_known]
    return len(words), min((known.index(word) for word in words if word in known), default=len(known)), len(place)
