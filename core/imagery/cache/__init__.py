"""Tiles kept for later captures, in one MBTiles file for each source, map type and date.

tile_cache  the folder of files: names, listing, size limit
tilestore   lookup and storage of the tiles of one source, map type and date
database    the SQLite files
"""
