"""Classes and modules of IR-SIM 2.12 that need an environment: construction of objects, the factory, parameters."""
