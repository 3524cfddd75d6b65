"""Plain materials, one for each color, for programs that do not show the color of a prim without one."""

from __future__ import annotations

from typing import Any

__all__ = ["paint"]

_ROUGHNESS = 0.6


def paint(stage: Any, prim: Any, color: tuple[float, float, float]) -> None:
    """Give a prim a color, as ``displayColor`` and as a material under ``/World/Looks``.

    Args:
        stage: The stage.
        prim: A mesh or another solid.
        color: Red, green, blue, from 0 to 1, as on a screen (sRGB).
    """
    from pxr import Gf, Sdf, UsdGeom, UsdShade, Vt

    linear = Gf.Vec3f(*(_linear(min(1.0, max(0.0, part))) for part in color))
    UsdGeom.Gprim(prim).CreateDisplayColorAttr(Vt.Vec3fArray([linear]))
    name = "color_" + "".join(f"{round(255 * min(1.0, max(0.0, part))):02x}" for part in color)
    UsdGeom.Scope.Define(stage, "/World/Looks")
    path = f"/World/Looks/{name}"
    made = stage.GetPrimAtPath(path)
    material = UsdShade.Material(made) if made else UsdShade.Material.Define(stage, path)
    if not made:
        shader = UsdShade.Shader.Define(stage, f"{path}/surface")
        shader.CreateIdAttr("UsdPreviewSurface")
        shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(linear)
        shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(_ROUGHNESS)
        shader.CreateOutput("surface", Sdf.ValueTypeNames.Token)
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)


def _linear(part: float) -> float:
    """A part of a color without the gamma of sRGB, as OpenUSD has it (IEC 61966-2-1)."""
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4
