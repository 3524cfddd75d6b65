"""Other formats and programs: exports of recorded runs, maps from other worlds, robots and simulators."""
