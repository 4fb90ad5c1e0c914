"""TerrAInav without a GUI: missions over map imagery, their capture, and the resulting datasets.

Rooms, each importing only from earlier ones: text, external, storage, geodesy, mission and imagery, world, dataset,
capture, report and pairs, cli. The modules here are shared by all of them:

- `errors`: all errors raised on purpose, and messages
- `limits`: limits on input, waiting and storage
- `addresses`: passwords and keys in addresses
- `numbers`: parsing of numbers
- `arrays`: array types
- `units`, `fields`: declared fields of missions, and units
- `bands`: channels of images, and the display of more than 8 bits
- `map_types`: kinds of imagery
- `resources`: shipped data files, and the version
- `timing`: measured processor time
- `waiting`: waiting for other threads
"""
