"""Exit codes of the command."""

#: Done; some pictures failed; bad input; the source or the folder failed; internal error (EX_SOFTWARE of BSD's
#: sysexits.h); stopped by the user with Ctrl-C.
DONE, INCOMPLETE, BAD_INPUT, FAILED, FAULT, STOPPED = 0, 1, 2, 3, 70, 130


def exit_code(number: int) -> int:
    """Exit code of a command stopped by a signal, as in shells: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP."""
    return 128 + number
