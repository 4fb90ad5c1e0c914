"""TerrAInav without any GUI: missions planned and captured over map imagery, and the datasets that come of them.

Rooms, each on those before it: geodesy, mission and imagery, world, dataset, capture, report and pairs, cli.

errors      every error that is raised on purpose
limits      how much is read, waited for and kept at most
arrays      arrays, as annotations name them
bands       what a picture's channels are, and how values of more than 8 bits are shown
numbers     numbers in text of strangers
text        text of strangers, on one line and without keys
files       files written whole or not at all, and held by one run at a time
safe_json   JSON of strangers
config      what the user keeps in the configuration folder
units       what numbers are in, in words and as they are typed
resources   what ships beside the code
drawing     what all diagrams have in common
unexpected  errors that nobody foresaw
native_calls  calls into libraries in C, which Ctrl-C must not wait for
"""
