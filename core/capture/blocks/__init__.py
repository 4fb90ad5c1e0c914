"""A capture in blocks of neighbouring images, which other processes and machines make.

In reading order:

- `division`: which captures make a block
- `block`: a block as a plain value, and how it is made
- `shards`: many images in one file
- `destination`: where results go, and what of them is there
- `engines`: who runs blocks
- `running`: the run, from the first block to the tables
"""
