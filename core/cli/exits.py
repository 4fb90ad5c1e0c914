"""Exit codes of the command."""

#: Some pictures could not be had; bad input; the source or the folder failed; stopped by the user.
DONE, INCOMPLETE, BAD_INPUT, FAILED, STOPPED = 0, 1, 2, 3, 130
