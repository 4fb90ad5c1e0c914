"""Code of others that runs in this process.

- `importing`: libraries that may be missing
- `drawing`: diagrams by matplotlib
- `native_calls`: calls into C libraries that Ctrl-C can leave
- `user_code`: the user's own methods
- `unexpected`: unforeseen errors, turned into failures of single parts
"""
