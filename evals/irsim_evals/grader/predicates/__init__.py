"""Predicates: what an assertion can say. Each is one file, named like the key under which cases use it."""
