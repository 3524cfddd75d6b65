"""From files of weights that users bring to policies of irsim; no code of such a file runs."""
