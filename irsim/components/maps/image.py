"""``image``: dark pixels are occupied."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.maps._site import MapSite, Raster, replacement_map
from irsim.components.options import MapOptions
from irsim.options.registry import MAPS


class ImageMap(MapOptions):
    """A grey-scale picture stretched over the world: black is occupied, white is free."""

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
    from irsim.components.maps._picture import image_raster, open_picture

    path = site.find(options.path)
    own = replacement_map(options.path)
    if own is not None and path.name == own:
        site.notes.append(("map-stand-in", f"'{options.path}' is not included: '{own}' is used instead"))
    return image_raster(*open_picture(path, options.path, site))
