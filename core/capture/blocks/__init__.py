"""A capture in blocks of neighbouring images, which other processes and machines make.

In reading order:

- `division`: dividing captures into blocks
- `block`: a block as a plain value, and how it is made
- `shards`: many images in one file
- `journal`: the journal of a capture block by block
- `engines`: executors that run blocks
- `running`: handing blocks to an engine
"""
