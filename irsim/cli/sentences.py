# ruff: noqa: E501
"""First sentences of the commands; ``python -m irsim.cli.overview`` writes this file."""

SENTENCES = {
    "demo": "Simulate a bundled scenario and write an animation of it to the current directory.",
    "templates": "List the bundled scenarios to start from.",
    "new": "Write a new scenario from a template and its parameters.",
    "studio": "Open a page with the text and the scene of a scenario side by side: write, drag, check, run.",
    "validate": "Check scenario files, suites and tasks without running them; the exit code is 2 if any file is invalid.",
    "diff": "List the differences between two scenarios: keys of the files, and properties of the resulting worlds.",
    "run": "Simulate a scenario until every robot has arrived or collided, or the time limit is reached.",
    "inspect": "Print tables of a run that was recorded with `irsim run --record`.",
    "diff-runs": "Find the first step in which two recorded runs differ, and in what; the exit code is 1 if they differ.",
    "audit": "Check recorded runs from their files alone: contacts, limits, arrivals, outcome and metrics; no engine runs.",
    "replay": "Write a recorded run as one HTML page: play it, scrub, follow a robot, jump to events.",
    "export": "Write recorded runs for other programs: tables, ROS 2 bags, datasets, cameras, scenes of other simulators.",
    "benchmark": "Compare policies: run every scenario with every policy and the same seeds, on all cores.",
    "suites": "List the bundled suites: benchmarks with fixed scenarios, seeds, horizon, protocol and policies.",
    "policies": "List the policies that can drive robots, describe one, or say which of them suit a scenario (--for).",
    "train": "Train a policy for a task; needs the extra `learn`. Success is measured on seeds that are not trained on.",
    "export-policy": "Make a policy file of a training, with its model card and curve; needs the extra `learn`.",
    "convert": "Make a policy file of weights that others trained with PyTorch; no code of their file runs, and no torch.",
    "render": "Draw a scenario, or a recorded run (its id, its folder or `last`), as a picture or an animation.",
    "describe": "Explain a key, a component, a template, a metric or an error code. Without a topic, list all topics.",
    "schema": "Write the JSON Schemas of scenarios, suites, tasks and networks, or connect a scenario file to its schema.",
    "map": "Import maps from other worlds into scenarios: meshes, navigation meshes, USD, roads, ROS; and export maps.",
    "bridge": "Bridges to other programs: robots, simulators and their formats.",
    "skills": "List and install the skills for coding agents.",
}
