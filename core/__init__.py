"""TerrAInav without any GUI: missions planned and captured over map imagery, and the datasets that come of them.

Rooms, each on those before it: text, external, storage, geodesy, mission and imagery, world, dataset, capture, report
and pairs, cli. Here lies what all of them share:

- `errors`: every error that is raised on purpose, and messages
- `limits`: limits on what is read, waited for and kept
- `addresses`: passwords and keys in addresses
- `numbers`: numbers in text from outside
- `arrays`: types of arrays
- `units`, `fields`: declared fields of missions, with their units
- `bands`: channels of images, and how more than 8 bits are displayed
- `map_types`: kinds of imagery
- `resources`: files that ship beside the code
- `timing`: measured processor time
- `waiting`: waiting for other threads
"""
