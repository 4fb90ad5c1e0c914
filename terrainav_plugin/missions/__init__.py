"""Missions and datasets: opened, saved, and taken up again."""
