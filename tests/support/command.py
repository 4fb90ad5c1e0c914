"""The command run in the test's process, for a user with nothing configured or cached."""

from __future__ import annotations

import os
from typing import NamedTuple

from terrainav.core.cli import main
from terrainav.core.imagery.http.client import Client


class Finished(NamedTuple):
    """Exit code and output of a command."""

    returncode: int
    stdout: str
    stderr: str


def command(tmp_path, monkeypatch, capsys):
    """Return a function that runs the command in ``tmp_path``; keywords are its environment."""
    for name in [name for name in os.environ if name.startswith("TERRAINAV_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    # Requests to servers that do not answer are repeated; the wait in between does not matter here.
    monkeypatch.setitem(Client.__init__.__kwdefaults__, "first_wait_s", 0.001)

    def run(*arguments, **environment):
        with monkeypatch.context() as patched:
            for name, value in environment.items():
                patched.setenv(name, value)
            capsys.readouterr()
            try:
                code = main(arguments)
            except SystemExit as stopped:
                code = stopped.code
        return Finished(code, *capsys.readouterr())

    return run
