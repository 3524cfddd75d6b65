"""The input and the output of map generators: the world that wants a map, files to read, rasters and noise."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import nearest
from irsim.diagnostics.errors import PickledWhole

__all__ = [
    "FREE",
    "HALF",
    "OCCUPIED",
    "UNKNOWN",
    "UNKNOWN_AS",
    "MapProblem",
    "MapSite",
    "Noise",
    "Raster",
    "bundled_map",
    "bundled_names",
    "cells_along",
    "replacement_map",
]

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from irsim.common.arrays import Floats

FREE, OCCUPIED, UNKNOWN = 0.0, 100.0, -1.0
"""Occupancies of cells, as in maps of ROS; those between free and occupied are probabilities.

Beams and bodies pass unknown cells, planners and random places avoid them.
"""
HALF = 50
"""Occupancy up to which a cell counts as free; cells with a larger one count as occupied."""
UNKNOWN_AS = {"free": 20.0, "occupied": 75.0, "unknown": UNKNOWN}
"""Occupancies of cells whose occupancy the map does not give, by what they count as; pictures show them as grey."""
_SLIP = 0.85
"""Similarity from which on a name is taken for a slip of the name of a bundled map, which shall not replace a plan."""
_MAX_CELLS_ALONG = 1e15
"""Number of cells that a count is cut to, so that it stays an exact integer; no map is that large."""


def cells_along(length: float, size: float) -> int:
    """Number of cells of about ``size`` [m] along a ``length`` [m], at least one."""
    return max(1, round(min(length / size, _MAX_CELLS_ALONG)))


class MapProblem(PickledWhole, Exception):
    """The reason why a map cannot be made, with the fields of a diagnostic.

    Attributes:
        code: From :data:`irsim.diagnostics.codes.CODES`.
        key: Key of the mapping that is at fault; None for the mapping itself.
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
    """Occupancies of the cells of a rectangle.

    Attributes:
        levels: (nx, ny) one number per cell, i along +x, j along +y; negative where unknown.
        table: Occupancy (0 to 100) of each level; None if the levels are occupancies.
        width, height: Extent that the source prescribes [m]; None if it prescribes none.
        origin: Lower left corner that the source prescribes [m]; None if it prescribes none.
        unknown_share: Share of the cells whose occupancy the source does not give, whatever they count as.
    """

    levels: NDArray[Any]
    table: Floats | None = None
    width: float | None = None
    height: float | None = None
    origin: tuple[float, float] | None = None
    unknown_share: float = 0.0

    def values(self) -> Floats:
        """(nx, ny) occupancies, 0 to 100, -1 where unknown."""
        import numpy as np

        return np.asarray(self.levels if self.table is None else np.take(self.table, self.levels), dtype=np.float64)

    def occupied(self) -> NDArray[np.uint8]:
        """(nx, ny) 1 where the occupancy is above half."""
        import numpy as np

        full = self.levels > HALF if self.table is None else (self.table > HALF)[self.levels]
        return np.ascontiguousarray(full, dtype=np.uint8)

    def unknown(self) -> NDArray[np.uint8] | None:
        """(nx, ny) 1 where the occupancy is unknown; None if all cells are known."""
        import numpy as np

        negative = self.table is None and self.levels < 0
        return np.ascontiguousarray(negative, dtype=np.uint8) if np.any(negative) else None


@dataclass
class Noise:
    """Gradient noise that is drawn for each scene: number of cells along x and y, and the options of the noise."""

    size: tuple[int, int]
    complexity: float
    fill: float
    fractal: int
    attenuation: float


@dataclass
class MapSite:
    """The world that a map is made for, the files that the generator may read, and its limits.

    Attributes:
        width, height: Extent of the world [m]; None if the map determines it.
        origin: Lower left corner of the world [m]; None if the map determines it.
        folders: Folders in which files are looked for, in order.
        bundled: Function from the name of a bundled map to its file.
        bundled_names: Function that returns the names of the bundled maps.
        refuse: Function that returns why a file name is not allowed, or None; its arguments are the name and the
            folders that it may be relative to.
        max_cells: Largest number of cells of a map.
        max_bytes: Largest size of a file.
        notes: Hints for the user, as (code, sentence).
        kept: Name -> file to read without looking for it.
        files: Name -> file that was read, without bundled maps.
        says_places: Whether messages name the folders that were searched, which a server keeps to itself.
    """

    width: float | None = None
    height: float | None = None
    origin: tuple[float, float] | None = None
    folders: Sequence[Path] = ()
    bundled: Callable[[str], Path | None] = lambda name: None
    bundled_names: Callable[[], list[str]] = list
    refuse: Callable[[str, Sequence[Path]], str | None] = lambda name, folders: None
    max_cells: int = 64_000_000
    max_bytes: int = 256 * 1024**2
    notes: list[tuple[str, str]] = field(default_factory=list)
    kept: Mapping[str, str] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    says_places: bool = True

    def find(self, name: str, beside: Path | None = None) -> Path:
        """The file of that name.

        Args:
            name: The name as written.
            beside: Folder to look in first.

        Raises:
            MapProblem: The file does not exist, is not allowed, or is too large.
        """
        if name in self.kept:
            return self._check_size(Path(self.kept[name]), name)
        folders = [*([beside] if beside is not None else []), *self.folders]
        wrong = self.refuse(name, folders)
        if wrong is not None:
            raise MapProblem(
                "path-outside-workspace", f"'{name}' {wrong}", given=name, allowed="files inside the workspace"
            )
        for path in (folder / Path(name).expanduser() for folder in folders):
            try:
                if path.is_file():
                    self.files[name] = os.path.abspath(path)
                    return self._check_size(path, name)
            except (OSError, ValueError):
                continue
        bundled = self.bundled(name)
        if bundled is not None:
            return bundled
        near = self._near(name, folders)
        places = list(dict.fromkeys(os.path.abspath(folder) for folder in folders))
        searched = (
            ""
            if Path(name).is_absolute() or not self.says_places
            else f" in {', '.join(clean(one, 200) for one in places)}"
        )
        raise MapProblem(
            "map-not-found",
            f"there is no map file '{name}'{searched}",
            given=name,
            allowed=f"a file beside the scenario, or a bundled map: {', '.join(self.bundled_names())}",
            fix=f"path: {near}" if near is not None else "give the path of the file relative to the scenario",
        )

    def check_cells(self, columns: int, rows: int, key: str | None = "path") -> None:
        """Refuse a map of too many cells before any cell is made.

        Raises:
            MapProblem: The map would have too many cells.
        """
        if columns * rows > self.max_cells:
            raise MapProblem(
                "map-too-large",
                f"a map may have at most {self.max_cells:,} cells, got {columns:,} x {rows:,}",
                key=key,
                allowed=f"at most {self.max_cells:,} cells",
                fix="use a smaller picture, or a coarser resolution",
            )

    def _check_size(self, path: Path, name: str) -> Path:
        size = path.stat().st_size
        if size > self.max_bytes:
            raise MapProblem(
                "map-too-large",
                f"a map file may have at most {self.max_bytes:,} bytes, but '{name}' has {size:,}",
                given=name,
                allowed=f"at most {self.max_bytes:,} bytes",
            )
        return path

    def _near(self, name: str, folders: Sequence[Path]) -> str | None:
        """The name of a file or bundled map of the same kind that is similar to ``name``; None if none is.

        A picture of the user that is missing is never replaced by a bundled one of another kind.
        """
        suffix = Path(name).suffix.lower()
        bundled = [own for own in self.bundled_names() if Path(own).suffix == suffix]
        choices = [own for own in bundled if nearest(name, [own], _SLIP) is not None]
        for folder in folders:
            try:
                inside = sorted((folder / name).parent.iterdir())[:2000]
            except (OSError, ValueError):
                continue
            choices += [str(Path(name).parent / p.name) for p in inside if p.suffix.lower() == suffix]
        return nearest(name, choices)


_FOLDER = Path(__file__).parent / "_data"
_STAND_INS = {f"hm3d_{number}.png": f"flat_{1 + (number - 1) % 2}.png" for number in range(1, 10)}
"""Indoor scans of IR-SIM that cannot be redistributed, and the bundled flats that replace them."""


def bundled_names() -> list[str]:
    """File names of the bundled maps, sorted, without the names that other maps replace."""
    return sorted(path.name for path in _FOLDER.glob("*.png"))


def replacement_map(name: str) -> str | None:
    """The bundled map that replaces a map that is not included; None for any other name."""
    return _STAND_INS.get(name)


def bundled_map(name: str) -> Path | None:
    """The file of a bundled map; None if no bundled map has that name."""
    path = _FOLDER / _STAND_INS.get(name, name)
    return path if path.parent == _FOLDER and path.name in bundled_names() else None
