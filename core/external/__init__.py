"""Foreign code that runs in this process.

- `importing`: optional libraries
- `compiling`: code compiled by numba
- `drawing`: diagrams with matplotlib
- `native_calls`: interruptible calls into C libraries
- `user_code`: methods written by the user
- `unexpected`: conversion of unforeseen errors to failures of single parts
"""
