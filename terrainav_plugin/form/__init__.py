"""The panel's entries as one plain value, and the mission that they ask for. Knows no widget.

text            numbers, aspect ratios and degrees as people type and read them
fields          what people read of a field that a mission declares
state           the entries, each a field; as JSON between sessions
area            the area: a box, a polygon or points; from pasted text, and in words
camera          the camera by field of view, lens and sensor, or ground sample distance
presets         values for a purpose, as entries
headings        what groups of entries hold, in a few words
mission_form    the mission that entries ask for, and the entries that ask for a mission
"""
