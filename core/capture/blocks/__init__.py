"""Capture in blocks of neighbouring images, made by other processes and machines.

In reading order:

- `division`: divide captures into blocks
- `block`: a block as a plain value, and the function that makes it
- `shards`: many images in one file
- `journal`: the journal of a capture block by block
- `engines`: executors of blocks
- `running`: hand blocks to an engine
"""
