"""Exit codes of the command."""

#: Some pictures could not be had; bad input; the source or the folder failed; a fault of the program itself
#: (EX_SOFTWARE of BSD's sysexits.h); stopped by the user with Ctrl-C.
DONE, INCOMPLETE, BAD_INPUT, FAILED, FAULT, STOPPED = 0, 1, 2, 3, 70, 130


def exit_code(number: int) -> int:
    """Exit code of a command that was stopped by a signal, as shells have it: 130, 143 of SIGTERM, 129 of SIGHUP."""
    return 128 + number
