"""The panel's entries as one plain value, and the mission made from them. No widgets.

text            numbers, aspect ratios and degrees as people type and read them
fields          translated titles and tips of a mission's fields
state           the entries as one dataclass, kept as JSON between sessions
area            the area: a box, a polygon or points; read from pasted text, and described in words
camera          the camera by field of view, lens and sensor, or ground sample distance
presets         presets of entries: applied, undone and recognised
headings        summaries of the groups of entries
mission_form    the mission of the entries, and the entries of a mission
"""
