"""The formats: module ``x`` has the constant ``FORMAT`` of the format ``x``; modules ``_x`` help them.

``FORMAT`` has the name, suffix and libraries, the function that writes episodes, and the model of its options, which
users give with ``--set`` and the function finds in ``episode.options``; ``registry.Format`` explains its fields. The
docstring of the module is the page of the format in the references, and the guide ``exports`` in
``irsim/lookup/guides.py`` names it.

A table reads ``episode.blocks()``, never a whole run; a format with geometry reads ``recorded_scene(episode.run)``,
whose objects have outlines (as in ``commonroad``). ``episode.run.result`` has outcomes and times, and is None for a run
that was interrupted. It raises ``RunError(code, what, fix)`` for a run that it cannot write. Libraries are imported
when the function is called; they belong to the extra ``records``, or to the one that ``FORMAT`` names as ``extra``, and
the test is then marked ``records`` or ``interop``, opens the file with the tool that it is for, and ``TOOLS`` in
``noxfile.py`` installs the tool.
"""
