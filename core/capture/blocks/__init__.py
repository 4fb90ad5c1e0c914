"""Capture in blocks of neighbouring images, which other processes and machines make.

In reading order:

- `division`: divide captures into blocks
- `block`: a block as a plain value, and how it is made
- `shards`: many images in one file
- `journal`: the journal of a capture block by block
- `engines`: executors of blocks
- `running`: hand blocks to an engine
"""
