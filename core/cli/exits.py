"""Exit codes of the command."""

#: Everything is done.
DONE = 0
#: Some images failed.
INCOMPLETE = 1
#: The input is invalid.
BAD_INPUT = 2
#: The source or the folder failed.
FAILED = 3
#: Internal error: EX_SOFTWARE of BSD's sysexits.h.
FAULT = 70
#: Stopped by the user with Ctrl-C.
STOPPED = 130


def exit_code(number: int) -> int:
    """Exit code of a command stopped by a signal, as in shells: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP."""
    return 128 + number
