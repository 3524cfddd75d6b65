"""The tables of the page on policies that the IR-SIM paper compares: ``python -m tests.benchmarks.paper --help``."""
