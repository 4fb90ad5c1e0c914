"""Rights of an ordinary user for a process of root, which may otherwise write to every folder."""

from __future__ import annotations

import ctypes
import os

_CAP_DAC_OVERRIDE = 1
#: Version of the interface with capabilities in two words of 32 bits (linux/capability.h).
_VERSION_3 = 0x20080522


class _Header(ctypes.Structure):
    _fields_ = [("version", ctypes.c_uint32), ("pid", ctypes.c_int)]


class _Data(ctypes.Structure):
    _fields_ = [(name, ctypes.c_uint32) for name in ("effective", "permitted", "inheritable")]


def obey_permissions() -> None:
    """Give up root's right to write where permissions forbid it, permanently; no effect for other users.

    Changing the user would not do: the project may be in a folder that only root may read.
    """
    if os.getuid() != 0:
        return
    libc, header, data = ctypes.CDLL(None, use_errno=True), _Header(_VERSION_3, 0), (_Data * 2)()
    if libc.capget(ctypes.byref(header), data) != 0:
        raise OSError(ctypes.get_errno(), "capget")
    data[0].effective &= ~(1 << _CAP_DAC_OVERRIDE)
    data[0].permitted &= ~(1 << _CAP_DAC_OVERRIDE)
    if libc.capset(ctypes.byref(header), data) != 0:
        raise OSError(ctypes.get_errno(), "capset")
