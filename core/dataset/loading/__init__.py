"""Images and labels for training.

batches       selection of images and labels, and batches of them as numpy arrays
augment       images turned, mirrored, zoomed and shaded
torch_loader  the same batches for PyTorch
keras_loader  the same batches for Keras
"""

from __future__ import annotations

from .batches import Batches, LabelledImages

__all__ = ["Batches", "LabelledImages"]
