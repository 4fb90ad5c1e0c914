"""Height profile of the entered mission's flight, beside the map.

chart       the diagram, with a cursor that mouse and keyboard move
dock        the panel below the map
profiles    keeps the profile up to date, and shows its places on the map
"""
