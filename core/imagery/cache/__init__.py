"""Tiles that are kept for later captures, one MBTiles file a source, style and date."""
