"""Missions and datasets: opened, saved, and taken up again.

missions        the menu of missions, and what it does: a dataset is opened in the background
address_dialog  where a dataset is that is on no disk of this machine
plan_export     the plan in the panel, written as a file for other programs
"""
