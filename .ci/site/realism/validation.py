"""The comparison on a model's page: simulated values beside its law, and one measured number with its tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

__all__ = ["Curve", "Validation"]

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Curve:
    """Points or a line of a plot.

    Attributes:
        label: Its name in the legend; empty for none.
        x, y: (K,) coordinates.
        tone: Number of its colour; what belongs together has the same.
        faint: Whether it is only there to compare with, and drawn dashed.
    """

    label: str
    x: ArrayLike
    y: ArrayLike
    tone: int = 0
    faint: bool = False


@dataclass(frozen=True)
class Validation:
    """A model beside its law.

    Attributes:
        x, y: Labels of the axes, with unit.
        points: Curves of simulated values, drawn as points.
        lines: Curves of the law, drawn as lines.
        quantity: The measured quantity, as the subject of a sentence.
        measured: Its value in the simulation.
        expected: Its value by the law.
        tolerance: Largest difference of both that passes.
        unit: Unit of the three; empty for a pure number.
        setup: The simulated situation, as a sentence.
        paths: Whether the plot shows ways in the plane, in which both axes have the same scale.
        logarithmic: Axes with a logarithmic scale: ``x``, ``y`` or ``xy``; empty if both are linear.
    """

    x: str
    y: str
    points: tuple[Curve, ...]
    lines: tuple[Curve, ...]
    quantity: str
    measured: float
    expected: float
    tolerance: float
    unit: str
    setup: str
    paths: bool = False
    logarithmic: str = ""

    @property
    def passes(self) -> bool:
        """Whether the measured value is within the tolerance."""
        return abs(self.measured - self.expected) <= self.tolerance

    def shown(self, value: float) -> str:
        """A value with its unit, and with one digit more than the tolerance has, at most five."""
        digits = min(5, max(0, 1 - math.floor(math.log10(self.tolerance))))
        return self._with_unit(f"{value:.{digits}f}")

    @property
    def margin(self) -> str:
        """The tolerance with its unit."""
        value = f"{self.tolerance:.3g}"
        if "e" in value:
            mantissa, _, exponent = value.partition("e")
            power = f"10{str(int(exponent)).translate(_RAISED)}"
            value = power if mantissa == "1" else f"{mantissa} · {power}"
        return self._with_unit(f"± {value}")

    def _with_unit(self, value: str) -> str:
        """A number, whose minus is as long as a plus, in one line with its unit."""
        return f"{value} {self.unit}".rstrip().replace(" ", "\N{NO-BREAK SPACE}").replace("-", "\N{MINUS SIGN}")

    @property
    def caption(self) -> str:
        """Sentences below the plot: the simulated situation, and the measured value beside the law."""
        return (
            f"{self.setup} {self.quantity}: measured {self.shown(self.measured)}, by the equation "
            f"{self.shown(self.expected)}, tolerance {self.margin}."
        )
