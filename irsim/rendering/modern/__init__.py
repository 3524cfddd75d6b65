"""The style `modern`: one pass over a scene, after which it is drawn in units of 1/96 inch, with themes and layouts."""
