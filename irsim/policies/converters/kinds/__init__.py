"""The kinds of weights that can be converted, one module each.

A module has the options, and the function of (weights, options) that returns a network; ``Weights.take`` finds an array
and says what is missing. ``irsim/policies/converters/torch_files/`` reads what ``torch.save`` wrote: its pickles import
nothing and call nothing. Tests convert made-up files of the same structure, and others that are refused.
"""
