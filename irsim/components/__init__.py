"""One module for each component of a scenario file: what its keys mean, and which kernel computes it.

A sensor is read and drawn as beams: it needs the keys of ``lidar2d`` that ``irsim/objects/sensors/lidar.py`` reads, and
``drawn_color`` and ``drawn_alpha``. A drive names its controls and their units (``control_rows``, ``control_units``),
and says with ``speeds``, ``turns`` and ``steered`` what they are: checks, metrics, messages and pictures go by these.
A shape or a distribution registers a function in Python instead of a kernel. A distribution that draws new places for
each scene has a kernel: a struct in ``irsim/core/world/spec.hpp``, and a method ``drawn_in`` that gives its fields.
"""
