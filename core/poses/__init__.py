"""Poses to fly missions from, and priors for poses that were flown.

In reading order:

- `track`: positions in the order of a file, thinned, and the mission points made of them
- `trajectories`: trajectories in metres of a local frame: TUM, KITTI, EuRoC
- `logs`: flight logs of PX4 and ArduPilot
- `gpx`: GPX tracks
- `reading`: the mission points of a file of any of these formats
- `random_poses`: random poses inside an area, from given distributions
- `settings`: options for reading files, for lines and patterns, and for sensor errors
- `line`: poses along a flown line
- `patterns`: corridors, orbits, and scans of walls and structures
- `priors`: simulated GNSS, compass and barometer readings for the poses of a dataset
"""
