"""Where pixels come from: sources, how missions name them, their transport and cache.

source       the protocol of a source: windows, parts, pixels
policy       the terms of a provider
systems      coordinate reference systems that services offer
tiles        tiles of a grid, their URL templates, and keys in addresses
placeholder  images by which providers say that they have no imagery
entry        a source of the catalogue: URLs, dates, grid and terms
opening      from the text in a mission to a source: described, then opened
catalogue    the sources known by name, shipped and the user's; terms are checked here
xyz          tiles by URL template
staticmap    Google Static Maps
mbtiles      a user's MBTiles file
decode       from the bytes of an answer to pixels
trial        one tile of a source, to try it

Further rooms: services, raster, http and cache.
"""
