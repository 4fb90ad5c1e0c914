"""TerrAInav without a GUI: missions over map imagery, their capture, and the resulting datasets.

See docs/contributing.md for the rooms and their order of imports. All rooms share the modules here:

- `errors`: all errors raised on purpose, and messages
- `limits`: limits on input, waiting and storage
- `addresses`: passwords and keys in addresses
- `numbers`: parsing of numbers
- `arrays`: array types
- `deflate`: compression of pixels
- `units`, `fields`: declared fields of missions, and units
- `bands`: channels of images, and the display of more than 8 bits
- `map_types`: kinds of imagery
- `resources`: shipped data files, and the version
- `timing`: measured processor time
- `waiting`: waiting for other threads
"""
