"""Images and labels for training.

batches       what of a dataset is taken, and batches of it as numpy arrays
augment       images turned, mirrored, zoomed and shaded
torch_loader  the same batches for PyTorch
keras_loader  the same batches for Keras
"""

from __future__ import annotations

from .batches import Batches, LabelledImages

__all__ = ["Batches", "LabelledImages"]
