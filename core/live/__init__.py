"""Frames on request: a camera of a mission that takes a picture from any pose, and the interfaces of other programs.

- `tiles`: tiles in memory, and what stands in for those that are late
- `camera`: pose and time in; picture, products and camera contract out
"""
