"""Frames on request: a camera of a mission that takes a picture from any pose, and the interfaces of other programs.

- `choices`: what the command and the panel offer
- `tiles`: tiles in memory, and what stands in for those that are late
- `camera`: pose and time in; picture, products and camera contract out
- `terms`: what providers' terms mean for live frames
- `realtime`: frames by a deadline, which say what stands in
- `encoding`: frames as files
- `serving`: frames for many clients at once
- `following`: poses of a vehicle that arrive late and with gaps, and its pose at an exposure's time
- `http`: HTTP, WebSocket and a page
- `airsim`: AirSim's clients
- `rtsp`: video in H.264
- `flightgear`: poses from flight simulators
- `links`: MAVLink's links on this machine
- `telemetry`: poses of a vehicle from its MAVLink messages
- `gimbal`: the gimbal of a MAVLink camera
- `mavlink`: a MAVLink camera
"""
