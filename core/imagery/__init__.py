"""Sources of pixels: their names in missions, transport and cache.

source       the protocol of a source: windows, parts, pixels
policy       the terms of a provider
systems      coordinate reference systems that services offer
tiles        tiles of a grid, their URL templates, and keys in addresses
placeholder  images that providers send instead of missing imagery
entry        an entry of the catalogue: URLs, dates, grid and terms of a source
opening      interpretation of the text that names a source in a mission
catalogue    sources by name, shipped or the user's; check of runs against terms
xyz          tiles by URL template
staticmap    Google Static Maps
mbtiles      a user's MBTiles file
decode       decoding of the bytes of an answer to pixels
trial        fetching of one tile, to try a source

Further rooms: services, raster, http and cache.
"""
