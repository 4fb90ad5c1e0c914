"""Open, save and resume missions and datasets.

missions        the menu of missions and its actions; datasets are opened in the background
address_dialog  the address of a remote dataset
plan_export     the panel's plan, written as a file for other programs
"""
