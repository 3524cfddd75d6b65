"""Small edits of a given scenario: the lines that a request is about change, all others stay."""
