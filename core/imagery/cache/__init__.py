"""Tiles that are kept for later captures, one MBTiles file a source, style and date.

tile_cache  the folder: its files, their names, its limit
tilestore   the tiles of one file, between a source and its server
freshness   how long an answer may be used again, and how it is asked for anew
tilefile    the file
"""
