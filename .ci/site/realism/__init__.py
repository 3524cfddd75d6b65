"""Models of realism: for each ``x.md``, the text of its page, and ``x.py``, which compares the simulator with its law.

``x.py`` has one function, ``validation``, which simulates the YAML example of the page and returns a
:class:`realism.validation.Validation`. ``models.py`` beside this folder makes pages of both, ``plots.py`` draws them,
and ``tests/docs/test_models.py`` holds every measured number to its tolerance.
"""
