"""Load images and labels for training.

augment       rotate, mirror, zoom and shade images
streaming     fetch shards of an object store ahead
batches       select images and labels, and make batches of numpy arrays
torch_loader  these batches for PyTorch
keras_loader  these batches for Keras
"""

from __future__ import annotations

from .batches import Batches, LabelledImages

__all__ = ["Batches", "LabelledImages"]
