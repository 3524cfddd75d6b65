"""Where a map is wanted, which files it may read, and what a map generator hands back."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.diagnostics.diagnostic import nearest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["MapProblem", "MapSite", "Noise", "Raster", "cells_along"]

_COUNTABLE = 1e15


def cells_along(length: float, size: float) -> int:
    """Cells of about a size over a length [m], at least one; a number too large for any map where there is none."""
    return max(1, round(min(length / size, _COUNTABLE)))


class MapProblem(Exception):
    """Why there is no map, with the fields of a diagnostic.

    Attributes:
        code: From :data:`irsim.diagnostics.codes.CODES`.
        key: Key of the mapping that is to blame; None for the mapping itself.
    """

    def __init__(
        self,
        code: str,
        message: str,
        *,
        key: str | None = "path",
        given: Any = None,
        allowed: Sequence[str] | str | None = None,
        fix: str | None = None,
    ) -> None:
        super().__init__(message)
        self.code, self.message, self.key = code, message, key
        self.given, self.allowed, self.fix = given, allowed, fix


@dataclass
class Raster:
    """Occupancy of a rectangle.

    Attributes:
        levels: (nx, ny) one number per cell, i along +x, j along +y.
        table: Occupancy (0 to 100) of each level; None: the levels are occupancies.
        width, height: Extent that the source itself prescribes [m].
        origin: Lower left corner that the source itself prescribes [m].
    """

    levels: NDArray[Any]
    table: Floats | None = None
    width: float | None = None
    height: float | None = None
    origin: tuple[float, float] | None = None

    def values(self) -> Floats:
        """(nx, ny) occupancies, 0 to 100."""
        import numpy as np

        return np.asarray(self.levels if self.table is None else np.take(self.table, self.levels), dtype=np.float64)

    def occupied(self) -> NDArray[np.uint8]:
        """(nx, ny) 1 where the occupancy is above 50."""
        import numpy as np

        full = self.levels > 50 if self.table is None else (self.table > 50)[self.levels]
        return np.ascontiguousarray(full, dtype=np.uint8)


@dataclass
class Noise:
    """Gradient noise that is drawn anew in every scene: cells along x and y, and the options of the noise."""

    size: tuple[int, int]
    complexity: float
    fill: float
    fractal: int
    attenuation: float


@dataclass
class MapSite:
    """What a map generator may know.

    Attributes:
        width, height: Extent of the world [m]; None where the scenario leaves it to the map.
        origin: Lower left corner of the world [m]; None where the scenario leaves it to the map.
        folders: Where files are looked for, in order.
        bundled: File by name of the maps that come along.
        refuse: Tells why a name may not be used, None if it may; gets the name and the folders it may be relative to.
        most_cells: Cells of a map.
        most_bytes: Size of a file.
        notes: (code, sentence) of what the user should know.
        kept: File by name where it is not looked for; these were found before.
        found: File by name of what was found, without the maps that come along.
    """

    width: float | None = None
    height: float | None = None
    origin: tuple[float, float] | None = None
    folders: Sequence[Path] = ()
    bundled: Callable[[str], Path | None] = lambda name: None
    bundled_names: Callable[[], list[str]] = list
    refuse: Callable[[str, Sequence[Path]], str | None] = lambda name, folders: None
    most_cells: int = 64_000_000
    most_bytes: int = 256 * 1024**2
    notes: list[tuple[str, str]] = field(default_factory=list)
    kept: Mapping[str, str] = field(default_factory=dict)
    found: dict[str, str] = field(default_factory=dict)

    def find(self, name: str, beside: Path | None = None) -> Path:
        """The file of that name.

        Args:
            name: As somebody wrote it.
            beside: Folder to look in first.

        Raises:
            MapProblem: There is none, it may not be read, or it is too large.
        """
        if name in self.kept:
            return self._checked(Path(self.kept[name]), name)
        folders = [*([beside] if beside is not None else []), *self.folders]
        wrong = self.refuse(name, folders)
        if wrong is not None:
            raise MapProblem(
                "path-outside-workspace", f"'{name}' {wrong}", given=name, allowed="files inside the workspace"
            )
        for path in (folder / Path(name).expanduser() for folder in folders):
            try:
                if path.is_file():
                    self.found[name] = os.path.abspath(path)
                    return self._checked(path, name)
            except (OSError, ValueError):
                continue
        bundled = self.bundled(name)
        if bundled is not None:
            return bundled
        near = self._near(name, folders)
        raise MapProblem(
            "map-not-found",
            f"there is no map file '{name}'",
            given=name,
            allowed=f"a file beside the scenario, or a bundled map: {', '.join(self.bundled_names())}",
            fix=f"path: {near}" if near is not None else "give the path of the file relative to the scenario",
        )

    def check_cells(self, columns: int, rows: int, key: str | None = "path") -> None:
        """Refuse a map of too many cells before any are made.

        Raises:
            MapProblem: Too many.
        """
        if columns * rows > self.most_cells:
            raise MapProblem(
                "map-too-large",
                f"{columns:,} x {rows:,} cells; a map may have {self.most_cells:,}",
                key=key,
                allowed=f"at most {self.most_cells:,} cells",
                fix="use a smaller picture, or a coarser resolution",
            )

    def _checked(self, path: Path, name: str) -> Path:
        size = path.stat().st_size
        if size > self.most_bytes:
            raise MapProblem(
                "map-too-large",
                f"'{name}' has {size:,} bytes; a map file may have {self.most_bytes:,}",
                given=name,
                allowed=f"at most {self.most_bytes:,} bytes",
            )
        return path

    def _near(self, name: str, folders: Sequence[Path]) -> str | None:
        """A file with a similar name."""
        choices = list(self.bundled_names())
        suffix = Path(name).suffix.lower()
        for folder in folders:
            try:
                inside = sorted((folder / name).parent.iterdir())[:2000]
            except (OSError, ValueError):
                continue
            choices += [str(Path(name).parent / p.name) for p in inside if p.suffix.lower() == suffix]
        return nearest(name, choices)
