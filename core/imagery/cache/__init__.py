"""Tiles kept for later captures, in one MBTiles file for each source, map type and date.

tile_cache  the folder: its files, their names, its limit
tilestore   the tiles of one source, map type and date: found, kept, written
database    the SQLite files
"""
