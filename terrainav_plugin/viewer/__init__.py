"""Captured images, looked at one by one."""
