"""A stand-in, not CARLA: a process that speaks the protocol of CARLA 0.9.16 to the official Python client.

It answers the calls that a bridge needs, moves walkers and vehicles with a few lines of kinematics, and casts rays with
irsim's own formulas for circles and segments. There is no physics, no rendering and no town of CARLA in it. The layouts
were found by running the client and by reading the public headers of LibCarla; all numbers are from version 0.9.16.
"""
