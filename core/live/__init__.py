"""Frames on request: a camera of a mission that takes a picture from any pose, and the interfaces of other programs.

- `choices`: what the command and the panel offer
- `tiles`: tiles in memory, and what stands in for those that are late
- `camera`: pose and time in; picture, products and camera contract out
- `encoding`: frames as files
- `serving`: frames for many clients at once
- `http`: HTTP, WebSocket and a page
- `airsim`: AirSim's clients
"""
