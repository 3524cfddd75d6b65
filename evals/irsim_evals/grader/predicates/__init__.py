"""Predicates: what an assertion can say, by subject; ``@register`` names the key under which cases use each."""
