"""Missions and plans: what the user asks for, worked out to poses, windows and figures. No I/O but files."""
