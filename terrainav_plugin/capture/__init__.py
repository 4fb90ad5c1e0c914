"""Captures: the queue, questions before a run, and messages after it.

run         one capture, from the queue to its end, and texts about its state
task        a capture as a QGIS task, with its mosaics
queue       the queue: one capture runs, the others wait; ended captures are listed until dismissed
questions   checks of the folder, the key and the source's terms
left        folders of captures that did not end
unfinished  captures interrupted, for example by a crash, and offered again
endings     results on the map, and a message about the outcome
"""
