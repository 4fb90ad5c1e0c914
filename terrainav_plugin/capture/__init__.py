"""Captures: the queue, questions before a run, and messages after it.

run         one capture, from the queue to its end, and what is said of it
task        a capture as a QGIS task, and what makes its images fit for the map
queue       one works, the others wait for it; those that are over stay until they are dismissed
questions   is there a folder, is it free, is there a key, do the source's terms allow it
unfinished  captures that did not end, as after a crash, found again and offered
endings     results on the map, and a message that says how a run ended
"""
