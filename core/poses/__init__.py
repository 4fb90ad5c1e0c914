"""Poses from elsewhere, as tables that missions are flown from, and priors of poses that were flown.

In reading order:

- `track`: positions along a way, thinned, and the points of a mission that are made of them
- `trajectories`: in metres of a local frame: TUM, KITTI, EuRoC
- `logs`: flight logs of PX4 and ArduPilot
- `gpx`: tracks of GNSS receivers
- `reading`: the points of a mission that the poses in a file are, whatever its format
- `random_poses`: random poses inside an area, from stated distributions
- `settings`: how files are read, how lines and patterns are flown, and how wrong sensors are
- `line`: the poses along a line that is flown
- `patterns`: corridors along lines, orbits around places, scans of walls and of structures
- `priors`: what a GNSS receiver, a compass and a barometer would have measured of the poses of a dataset
"""
