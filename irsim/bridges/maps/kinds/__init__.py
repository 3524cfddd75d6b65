"""Kinds of files that maps are made from, one module each.

Module ``x`` has ``KIND``: name, suffixes, how its first bytes look, extra and libraries, and the function that reads
a file. The function returns a ``Scene`` (triangles, from which levels and maps are made) or an ``Occupancy`` (a
finished map). It checks sizes before it allocates, follows no names of other places, and raises ``BridgeError``
through ``unusable``. Tests read small made-up files, truncated and hostile ones too, without libraries; tests marked
``interop`` read files that other programs wrote.
"""
