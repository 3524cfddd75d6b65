"""From what a request asks for to a scenario."""
