"""``python -m irsim_evals``."""

from irsim_evals.cli import main

main()
