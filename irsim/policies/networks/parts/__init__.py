"""Parts of observations: options, shapes and the function of arrays.

Tests try each part alone and in batches: a row must have the same bits in any company. NumPy's sums and exponential
functions do not; ``irsim/policies/networks/values.py`` and ``layers/_options.py`` have others. A part that gives other
numbers for the same options raises the version of the layout. ``irsim schema`` writes the schema of policies.
"""
