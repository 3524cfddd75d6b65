"""The layers of a stage of OpenUSD: all are looked at before the stage is opened, which would open any file they name.

A layer may lie in the folder of the stage or in the root that the user gives, or below them. Materials are not read, so
that they may be missing, damaged or anywhere.
"""

# ruff: noqa: E402  # the library is asked for first
from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irsim.bridges.maps.apart import Refused
from irsim.bridges.maps.named_files import lies_in, with_root
from irsim.common.extras import require
from irsim.common.text import clean

require("usd", "pxr")
from pxr import Ar, Sdf, Tf, Usd, UsdShade

__all__ = ["Layers", "flattening"]

_MAX_LAYERS = 5_000
_MATERIALS = (".mtlx", ".mdl")
"""How names of files end that hold materials only."""
_SHOWN = 150


def flattening(path: Path) -> str:
    """The advice to make one file of a stage, with a command that works where only pip's usd-core is installed."""
    name = path.as_posix()
    name = name if re.fullmatch(r"[\w./: -]+", name) else "in.usda"
    return f"flatten the stage: python -c \"from pxr import Usd; Usd.Stage.Open('{name}').Export('flat.usdc')\""


@dataclass
class Layers:
    """The layers of a stage.

    Attributes:
        path: The file of the stage.
        root: A second folder whose files the stage may refer to, besides its own one; None for none.
        missing: Names of layers that are not there.
        unread: Names of files that the library cannot read, such as materials.
    """

    path: Path
    root: Path | None
    missing: list[str] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)
    _kept: list[Any] = field(default_factory=list)
    """Layers that are held, as the library takes those in memory, which are changed, instead of their files."""

    def check(self) -> None:
        """Look at all layers, so that the library opens nothing else when it opens the stage.

        Raises:
            Refused: A layer is damaged, or refers to a file that lies elsewhere.
        """
        waiting, met = [str(self.path)], set[str]()
        with Ar.ResolverContextBinder(Ar.GetResolver().CreateDefaultContextForAsset(str(self.path))):
            while waiting:
                name = waiting.pop()
                if name in met:
                    continue
                met.add(name)
                if len(met) > _MAX_LAYERS:
                    raise Refused(f"it is made of more than {_MAX_LAYERS:,} layers")
                layer = self._opened(name)
                if layer is None:
                    continue  # the stage is composed without it
                self._kept.append(layer)
                for asset in filter(None, layer.GetCompositionAssetDependencies()):  # no name: the layer itself
                    target = layer.ComputeAbsolutePath(asset)
                    if _file_of(asset).lower().endswith(_MATERIALS):
                        self._leave(layer, asset, target)
                    else:
                        self._check_place(asset, target)
                        waiting.append(target)

    def check_clips(self, stage: Any) -> None:
        """Refuse value clips, whose files the library opens when it looks for a value of a prim or of one below it.

        Args:
            stage: The stage, of which no value was looked for so far.

        Raises:
            Refused: A prim has value clips.
        """
        for root in (stage.GetPseudoRoot(), *stage.GetPrototypes()):
            for prim in Usd.PrimRange(root, Usd.PrimAllPrimsPredicate):
                if prim.HasAuthoredMetadata("clips"):
                    what = f"{clean(str(prim.GetPath()), _SHOWN)} has value clips, which are other files"
                    raise Refused(what, flattening(self.path))

    def notes(self, stage: Any) -> list[str]:
        """Remarks about files that were not read.

        Args:
            stage: The stage.
        """
        notes = []
        if self.missing:
            notes.append(_listed(self.missing, "layer", "was not found", "were not found"))
        if self.unread:
            what = "of a kind that the library does not read, and was left out"
            notes.append(_listed(self.unread, "file", f"is {what}", f"are {what.replace('was', 'were')}"))
        textures = self._missing_textures(stage)
        if textures:
            notes.append(_listed(textures, "texture", "was not found", "were not found"))
        return notes

    def _opened(self, name: str) -> Any:
        """A layer; None if it is missing, or of a kind that the library cannot read."""
        file = _file_of(name)
        first = name == str(self.path)
        try:
            layer = Sdf.Layer.FindOrOpen(name)
        except Tf.ErrorException as error:
            shown = clean(os.path.basename(file), _SHOWN)
            if not first and Sdf.FileFormat.FindByExtension(file) is None:
                self.unread.append(shown)
                return None
            said = _reason(error)
            if first:
                raise Refused(f"it is damaged: {said}") from None
            what = f"its layer '{shown}' is damaged: {said}"
            raise Refused(what, "write that layer again, or take the reference to it out of the stage") from None
        if layer is None and first:
            raise Refused("it is damaged: it cannot be opened")
        if layer is None:
            self.missing.append(clean(os.path.basename(file), _SHOWN))
        return layer

    def _leave(self, layer: Any, asset: str, target: str) -> None:
        """Take a material out of a layer in memory, so that the library opens no file for it."""
        if "://" not in asset and self._inside(target) and not os.path.isfile(_file_of(target)):
            self.missing.append(clean(os.path.basename(_file_of(target)), _SHOWN))
        nothing = Sdf.Layer.CreateAnonymous()
        self._kept.append(nothing)
        layer.SetPermissionToEdit(True)
        if not layer.UpdateCompositionAssetDependency(asset, nothing.identifier):
            raise Refused(f"the material '{clean(asset, _SHOWN)}' cannot be left out", flattening(self.path))

    def _inside(self, target: str) -> bool:
        """Whether a file lies below the folder of the stage, or below the root."""
        file = _file_of(target)
        return os.path.isabs(file) and lies_in(Path(file), [self.path.resolve().parent, self.root])

    def _check_place(self, asset: str, target: str) -> None:
        """Refuse a reference to a file that may not be read."""
        address = "://" in asset or "://" in target
        place = target if os.path.isabs(_file_of(target)) else str(Ar.GetResolver().Resolve(target))
        if not address and not place:
            return  # nothing is there
        if not address and self._inside(place) and (self.root is not None or not os.path.isabs(asset)):
            return
        fix = flattening(self.path)
        if not address:
            fix = with_root(fix, self.path.resolve().parent, Path(_file_of(place)))
        what = f"it refers to '{clean(asset, _SHOWN)}', which is outside of its folder"
        raise Refused(f"{what}{'' if self.root is None else ' and of the root'} and is not read", fix)

    def _missing_textures(self, stage: Any) -> list[str]:
        """Names of pictures of materials that should be where the stage may look, and are not."""
        names = dict[str, None]()
        roots = [stage.GetPseudoRoot(), *stage.GetPrototypes()]
        for prim in (prim for root in roots for prim in Usd.PrimRange(root)):
            for given in UsdShade.Shader(prim).GetInputs() if prim.IsA(UsdShade.Shader) else []:
                specs = given.GetAttr().GetPropertyStack() if given.GetTypeName() == Sdf.ValueTypeNames.Asset else []
                layer, asset = next(((spec.layer, spec.default.path) for spec in specs if spec.default), (None, ""))
                target = "" if layer is None or "<" in asset or "://" in asset else layer.ComputeAbsolutePath(asset)
                if self._inside(target) and not os.path.isfile(_file_of(target)):
                    names[clean(os.path.basename(asset), _SHOWN)] = None
        return list(names)


def _file_of(identifier: str) -> str:
    """The file of a layer, which may be inside an archive or have arguments."""
    return str(Ar.SplitPackageRelativePathOuter(Sdf.Layer.SplitIdentifier(identifier)[0])[0])


def _reason(error: Exception) -> str:
    """The words of the library, without its own files and lines."""
    match = re.search(r"\bin file \S+ : '(.*?)'?\s*$", str(error).strip().splitlines()[0])
    return clean(match[1] if match else "it cannot be read", _SHOWN)


def _listed(names: list[str], thing: str, one: str, many: str) -> str:
    if len(names) == 1:
        return f"one of its {thing}s {one}: '{names[0]}'"
    return f"{len(names)} of its {thing}s {many}, such as '{names[0]}'"
