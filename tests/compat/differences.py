"""Facts of the scripts that differ on purpose: script → fact → the id in :data:`irsim.compatibility.DIFFERENCES`."""

KNOWN: dict[str, dict[str, str]] = {
    "avoidance_functions": {"wall": "D6"},  # a line met after half the look ahead does not count
    "shapes": {"sizes": "D2"},  # radius of the compound, whose round part is a 64-gon there
}
