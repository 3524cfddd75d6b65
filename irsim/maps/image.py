"""``image``: dark pixels are occupied."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.maps._options import MapOptions
from irsim.registry import MAPS


class ImageMap(MapOptions):
    """A grey-scale picture stretched over the world: black is occupied, white is free."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "image", "path": "cave.png"}]}

    name: Literal["image"] = "image"
    path: Annotated[str, Field(strict=True, min_length=1)]
    """Picture file: as written, beside the scenario, or one of the bundled maps."""


MAPS.register(ImageMap)
