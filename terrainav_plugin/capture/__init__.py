"""Captures: the queue, questions before a run, and messages after it.

run         one capture, from the queue to its end, and texts on its state
task        a capture as a QGIS task, with its mosaics
queue       one capture runs, the others wait; ended ones are listed until dismissed
questions   checks of the folder, the key and the source's terms
unfinished  captures that did not end, for example after a crash, offered again
endings     results on the map, and a message about the outcome
"""
