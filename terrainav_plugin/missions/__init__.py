"""Open, save and resume missions and datasets.

missions        the menu of missions and its actions; datasets are opened in the background
address_dialog  dialog for the address of a remote dataset
joined_export   export of several missions as one flight plan
plan_export     export of the panel's plan to a file for other programs
vehicle_export  upload of the panel's plan to a vehicle
"""
