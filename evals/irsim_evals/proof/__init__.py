"""The proof of the grader: right answers pass however they are written, wrong ones fail, and nothing passes by luck."""
