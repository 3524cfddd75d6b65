"""The formats: module ``x`` has the constant ``FORMAT`` of the format ``x``; modules ``_x`` help them.

``FORMAT`` has the name, suffix and libraries, the function that writes episodes, and the model of its options, which
users give with ``--set`` and the function finds in ``episode.options``. The function reads ``episode.blocks()``,
never a whole run, and imports its libraries when it is called. They belong to the extra ``records``, or to the one
that ``FORMAT`` names as ``extra``; its test is marked ``records`` or ``interop``, opens the file with the tool that
it is for, and ``TOOLS`` in ``noxfile.py`` installs the tool.
"""
