"""``image``: dark pixels are occupied."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.maps._site import MapSite, Raster, replacement_map
from irsim.components.options import MapOptions
from irsim.options.registry import MAPS


class ImageMap(MapOptions):
    """A picture stretched over the world, its top row at the largest y: what is darker than half white is occupied."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "image", "path": "cave.png"}]}

    name: Literal["image"] = "image"
    path: Annotated[str, Field(strict=True, min_length=1)]
    """Picture file: a path as given or relative to the scenario, or the name of a bundled map."""


@MAPS.register(ImageMap)
def image(options: ImageMap, site: MapSite) -> Raster:
    """The picture as a raster; its pixels need not be square.

    Raises:
        MapProblem: The picture does not exist or cannot be read.
    """
    from irsim.components.maps._picture import flattened, image_raster, open_picture

    path = site.find(options.path)
    own = replacement_map(options.path)
    if own is not None and path.name == own:
        site.notes.append(("map-stand-in", f"'{options.path}' is not included: '{own}' is used instead"))
    pixels, is_png = open_picture(path, options.path, site)
    raster = image_raster(flattened(pixels, options.path, site), is_png)
    doubts = _doubts(raster, site)
    if doubts:
        site.notes.append(("map-read-as", "; ".join(doubts)))
    return raster


_ASPECT = 1.1
"""Ratio of the sides of a pixel [m] from which on the user hears of it."""
_GREY = 0.02
"""Share of pixels that are neither dark nor bright from which on the user hears of the threshold."""


def _doubts(raster: Raster, site: MapSite) -> list[str]:
    """Sentences on what a picture leaves open: its extent, and what its grey pixels are."""
    import numpy as np

    said, (columns, rows) = [], raster.levels.shape
    if site.width and site.height:
        x, y = site.width / columns, site.height / rows
        if max(x, y) > _ASPECT * min(x, y):
            said.append(
                f"the picture has {columns} x {rows} pixels and the world {site.width:g} x {site.height:g} m, so a "
                f"pixel covers {x:.3g} x {y:.3g} m; its top row lies at the largest y"
            )
    values = raster.values() if raster.table is None else raster.table
    grey = (values > 30) & (values < 70)
    counts = None if raster.table is None else np.bincount(raster.levels.ravel(), minlength=len(values))
    share = float(grey.mean()) if counts is None else float(counts[grey].sum() / counts.sum())
    if share > _GREY:
        said.append(
            f"{share:.0%} of its pixels are grey: those darker than half of white are occupied, others are free"
        )
    return said
