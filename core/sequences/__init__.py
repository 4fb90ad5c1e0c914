"""Sequences: frames, inertial measurements and priors of one flight on one clock.

In reading order:

- `settings`: options of a sequence
- `trajectory`: the smooth path and attitude of a body in continuous time
- `inertial`: what an inertial unit measures on a trajectory
- `priors`: readings of a GNSS receiver, a barometer and a magnetometer
- `jsbsim`: aircraft of a flight dynamics model as tracks
- `files`: files of a sequence, and their tables
- `flying`: a flight as a sequence: trajectory, mission of its frames, and tables
"""
