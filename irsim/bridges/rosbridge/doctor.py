"""What ``irsim bridge doctor`` says of rosbridge."""

from __future__ import annotations

from irsim.bridges.doctor import Part

__all__ = ["PARTS"]

PARTS = (Part("roslibpy", "roslibpy", "rosbridge"),)
"""The libraries of the bridge."""
