"""The kinds of weights that can be converted, one module each."""
